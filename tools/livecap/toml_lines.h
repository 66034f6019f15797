// The part of TOML that options need: `name = value` below [section]s, with a value that is a string, a number, true or
// false, or an array of them. (CLI11's own reader takes what it does not understand for names, and knows no lines.)
#pragma once

#include <string>
#include <vector>

namespace livecap::tools {

struct TomlEntry {
  std::vector<std::string> section;  // {"actor", "build"} below [actor.build]; empty at the top
  std::string name;
  std::vector<std::string> values;  // without quotes; one, but for an array
  int line = 0;                     // 1: the first
};

// Throws ConfigError naming file and line.
std::vector<TomlEntry> read_toml(const std::string& text, const std::string& file);

}  // namespace livecap::tools
