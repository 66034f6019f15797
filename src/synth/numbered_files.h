// Pictures of one run, numbered from 0.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "base/text.h"

namespace livecap::synth {

// name: of a file by its number, as format() and sscanf() take it. Removes those from n on, also after a gap, that an
// earlier, longer run left in the folder, which would count as this run's.
inline void remove_numbered_from(int n, const std::filesystem::path& folder, const char* name) {
  std::error_code ignored;
  std::vector<std::filesystem::path> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string file = entry.path().filename().string();
    int number = 0;
    if (std::sscanf(file.c_str(), name, &number) == 1 && number >= n && file == format(name, number))
      left.push_back(entry.path());
  }
  for (const std::filesystem::path& file : left) std::filesystem::remove(file, ignored);
}

}  // namespace livecap::synth
