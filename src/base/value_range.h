// Which numbers an option takes: one constant for the library, which refuses others, and for the command line, which
// says so in its help.
#pragma once

#include <string>

namespace livecap {

struct ValueRange {
  double least, most;  // either included

  constexpr bool contains(double value) const { return value >= least && value <= most; }  // false for NaN
};

// Throws ConfigError: "--grid 50: must be between 3 and 30 mm".
void require_within(const std::string& option, double value, const ValueRange& range, const std::string& unit = "");

}  // namespace livecap
