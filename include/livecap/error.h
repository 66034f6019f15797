// Exceptions of the library. Every message says what failed, where (file, field, call), which value, and what would
// be right. What a video will contain anyway (nobody in view, a lost track) is a status, never an exception.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace livecap {

// Root of all exceptions thrown by this library.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Names in a message come from files: as UTF-8 of one line that tells a terminal nothing but letters. Control
// characters, Unicode's too, and bytes that are no UTF-8 are shown as '?'; what is longer than most bytes is cut.
std::string one_line(std::string_view text, size_t most = std::string_view::npos);

// A wrong option or a combination of options that makes no sense. Exit code 2.
class ConfigError : public Error {
 public:
  explicit ConfigError(const std::string& message) : Error(one_line(message)) {}
};

// An input that is missing, truncated, malformed or of the wrong size, or an output that cannot be written. Exit
// code 2.
class IoError : public Error {
 public:
  explicit IoError(const std::string& message) : Error(one_line(message)) {}
};

// No usable OpenCL device, or an OpenCL call that failed. Exit code 1.
class OclError : public Error {
 public:
  using Error::Error;
};

// A broken promise inside the library. Always a bug. Exit code 1.
class LogicError : public Error {
 public:
  using Error::Error;
};

}  // namespace livecap
