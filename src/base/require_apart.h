// What a run writes must not be what it reads: a file that is opened for writing first is lost, and one that is
// replaced in the end is no longer what it was made from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace livecap {

struct InputFile {
  std::string option;          // "--camera"
  std::filesystem::path path;  // empty: not given
};

// Links count as what they lead to; what is not there yet is nothing else. Throws ConfigError that names the option and
// the file.
void require_apart(const std::vector<InputFile>& inputs, const std::vector<std::filesystem::path>& outputs);

}  // namespace livecap
