#include "base/text.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/output_path.h"
#include "livecap/error.h"

namespace livecap {
namespace {

void write_stream(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.flush();
  if (!out) throw IoError(path.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) throw IoError(path.string() + ": no such file");
  if (std::filesystem::is_directory(path, code)) throw IoError(path.string() + ": is a folder, expected a file");
  // /dev/zero would never end.
  if (std::filesystem::is_character_file(path, code)) throw IoError(path.string() + ": is a device, expected a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IoError(path.string() + ": cannot be opened: " + std::strerror(errno));
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (in.bad()) throw IoError(path.string() + ": read failed: " + std::strerror(errno));
  return bytes;
}

void require_no_pipe(const std::filesystem::path& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
      !std::filesystem::is_directory(status))
    throw IoError(path.string() + ": is a pipe or a device, expected a file");
}

void write_file_atomically(const std::filesystem::path& path, const std::string& bytes) {
  if (is_stream(path)) return write_stream(path, bytes);
  const std::filesystem::path file = link_target(path);
  // Neither another process nor another thread writes there.
  static std::atomic<unsigned> n_written = 0;
  const std::filesystem::path temporary =
      file.string() + format(".tmp%d.%u", static_cast<int>(::getpid()), n_written.fetch_add(1));
  {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) {
      const std::string reason = std::strerror(errno);
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      throw IoError(path.string() + ": cannot be written: " + reason);
    }
  }
  std::error_code code;
  std::filesystem::rename(temporary, file, code);
  if (code) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw IoError(path.string() + ": cannot be written: " + code.message());
  }
}

}  // namespace livecap
