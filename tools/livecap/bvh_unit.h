// The option --bvh-unit.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace livecap::tools {

inline void add_bvh_unit_option(CLI::App& command, std::string& unit) {
  command.add_option("--bvh-unit", unit, "unit of BVH files")
      ->check(CLI::IsMember({"mm", "cm", "m"}))
      ->capture_default_str();
}

// Length of one in metres.
inline double bvh_unit_m(const std::string& unit) {
  return unit == "m" ? 1 : unit == "mm" ? 0.001 : 0.01;
}

}  // namespace livecap::tools
