#include "base/output_path.h"

#include "livecap/error.h"

namespace livecap {

namespace fs = std::filesystem;

fs::path link_target(fs::path path) {
  constexpr int kMostLinks = 40;  // as in Linux: some lead to each other
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(path, error); ++i)
    path = path.parent_path() / fs::read_symlink(path, error);
  return path;
}

bool is_stream(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_block_file(status) || fs::is_socket(status))
    throw IoError(path.string() + ": is a disk or a socket, expected a file to write");
  return fs::is_fifo(status) || fs::is_character_file(status);
}

}  // namespace livecap
