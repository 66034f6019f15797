// How the stages' times grow with the actor's vertices and with the picture.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "bench_capture.h"

namespace livecap::tools {

// Captures the built-in sequence in one thread, with actors of other vertex counts and as pictures of other sizes.
// scratch: where they are made. Throws Error when interrupted.
nlohmann::ordered_json measure_growth(const BenchOptions& options, const std::filesystem::path& scratch);

void print_growth(const nlohmann::ordered_json& growth);

}  // namespace livecap::tools
