#include "base/require_apart.h"

#include "base/output_path.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Also of files that are not there yet. A pipe takes one result after the other.
bool are_one_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code missing;
  if (a.empty() || b.empty() || is_stream(a)) return false;
  if (std::filesystem::equivalent(a, b, missing)) return true;
  const auto place = [&](const std::filesystem::path& file) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(link_target(file)), missing);
  };
  return place(a) == place(b);
}

}  // namespace

void require_apart(const std::vector<InputFile>& inputs, const std::vector<std::filesystem::path>& outputs,
                   const std::string& to_change) {
  for (const InputFile& input : inputs) {
    for (const std::filesystem::path& output : outputs) {
      std::error_code missing;
      if (std::filesystem::equivalent(input.path, output, missing))
        throw ConfigError(input.option + " " + input.path.string() +
                          ": would be overwritten by what this writes; give another " + to_change);
    }
  }
  for (size_t i = 0; i < outputs.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (are_one_file(outputs[i], outputs[j]))
        throw ConfigError(outputs[i].string() + ": two results would be written to it; give another " + to_change);
    }
  }
}

}  // namespace livecap
