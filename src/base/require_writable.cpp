#include "base/require_writable.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "livecap/error.h"

namespace livecap {

void require_writable(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw IoError(file.string() + ": is a folder, expected a file to write");
  if (!std::filesystem::is_directory(folder, ignored))
    throw IoError(file.string() + ": there is no folder " + folder.string());
  if (::access(folder.c_str(), W_OK) != 0)
    throw IoError(file.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace livecap
