// How the stages' times grow with the actor's vertices and with the picture.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "bench_capture.h"

namespace livecap::tools {

// The slope of a straight line through (log x, log y), by least squares. NaN for fewer than two different x or for
// values that are not positive.
double growth_exponent(std::span<const double> x, std::span<const double> y);

// Captures the built-in sequence in one thread, with actors of other vertex counts and as pictures of other sizes.
// scratch: where they are made. Throws Error when interrupted.
nlohmann::ordered_json measure_growth(const BenchOptions& options, const std::filesystem::path& scratch);

void print_growth(const nlohmann::ordered_json& growth);

}  // namespace livecap::tools
