// What a run writes must not be what it reads: a file that is opened for writing first is lost, and one that is
// replaced in the end is no longer what it was made from. Nor may two results be one file, of which the last is left.
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
// the file; to_change: the options that say what is written.
void require_apart(const std::vector<InputFile>& inputs, const std::vector<std::filesystem::path>& outputs,
                   const std::string& to_change = "--out");

}  // namespace livecap
