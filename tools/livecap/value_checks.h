// Which numbers an option takes, said so that a wrong one is told what is right. (CLI11's own checks print the limits
// of double where a range is open.)
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "base/value_range.h"

namespace livecap::tools {

// Not "", which a script makes of a variable that is not set.
CLI::Validator not_empty();

// Of uint64_t, which CLI11 takes for the largest where a number does not fit.
CLI::Validator whole_number();

// The error of each number: "--frames: must be at least 1, not 0".
CLI::Validator above(double bound);
CLI::Validator at_least(double least);
CLI::Validator between(const ValueRange& range, const std::string& unit = "");

}  // namespace livecap::tools
