#include "scratch_folder.h"

#include <cstdlib>
#include <string>

#include "livecap/error.h"

namespace livecap::tools {

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "livecap-XXXXXX").string();
  if (!::mkdtemp(pattern.data())) throw IoError(pattern + ": cannot be made");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace livecap::tools
