// Small text helpers for messages and file names.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <string>

namespace livecap {

// printf into a std::string.
[[gnu::format(printf, 1, 2)]] inline std::string format(const char* pattern, ...) {
  va_list args;
  va_start(args, pattern);
  va_list copy;
  va_copy(copy, args);
  const int size = std::vsnprintf(nullptr, 0, pattern, copy);
  va_end(copy);
  std::string text(size > 0 ? size : 0, '\0');
  if (size > 0) std::vsnprintf(text.data(), text.size() + 1, pattern, args);
  va_end(args);
  return text;
}

// Whole file as bytes, also from a pipe. Throws IoError naming the path when it cannot be read.
std::string read_file(const std::filesystem::path& path);

// Of a path that stands in a file from somewhere: a pipe would never begin, some devices never end. Throws IoError
// where it is neither a file nor a folder; what is missing is left to its reader.
void require_no_pipe(const std::filesystem::path& path);

// Writes through a temporary file and a rename, so that nobody sees half a file; a link's target is
// replaced, not the link, and a pipe or a device is written to as it is. Throws IoError.
void write_file_atomically(const std::filesystem::path& path, const std::string& bytes);

}  // namespace livecap
