#include "base/scratch_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "livecap/error.h"

namespace livecap {

ScratchFolder::ScratchFolder() {
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / "livecap-XXXXXX").string();
  if (error) throw IoError("TMPDIR: there is no folder for temporary files: " + error.message());
  if (!::mkdtemp(name.data())) throw IoError(name + ": cannot be created: " + std::strerror(errno));
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace livecap
