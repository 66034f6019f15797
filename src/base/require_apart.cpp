#include "base/require_apart.h"

#include "livecap/error.h"

namespace livecap {

void require_apart(const std::vector<InputFile>& inputs, const std::vector<std::filesystem::path>& outputs) {
  for (const InputFile& input : inputs) {
    for (const std::filesystem::path& output : outputs) {
      std::error_code missing;
      if (std::filesystem::equivalent(input.path, output, missing))
        throw ConfigError(input.option + " " + input.path.string() +
                          ": would be overwritten by what this writes; give another --out");
    }
  }
}

}  // namespace livecap
