#include "base/require_writable.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/output_path.h"
#include "livecap/error.h"

namespace livecap {

void require_writable(const std::filesystem::path& file) {
  const std::filesystem::path target = link_target(file);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw IoError(file.string() + ": is a folder, expected a file to write");
  if (!std::filesystem::is_directory(folder, ignored))
    throw IoError(file.string() + ": there is no folder " + folder.string());
  // A file is replaced, which its folder has to allow; a pipe or a device is written to itself.
  if (::access(is_stream(file) ? file.c_str() : folder.c_str(), W_OK) != 0)
    throw IoError(file.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace livecap
