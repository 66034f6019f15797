// What a TOML file says, as options need it: names with their section, values as text, and the lines they stand in.
// (CLI11's own reader takes what it does not understand for names, and knows no lines.)
#pragma once

#include <string>
#include <vector>

namespace livecap::tools {

struct TomlEntry {
  std::vector<std::string> section;  // {"actor", "build"} below [actor.build]; empty at the top
  std::string name;
  std::vector<std::string> values;  // one, but for an array
  int line = 0;                     // 1: the first
};

// Values may be strings, numbers, true, false and arrays of them. Throws ConfigError naming file and line.
std::vector<TomlEntry> read_toml(const std::string& text, const std::string& file);

}  // namespace livecap::tools
