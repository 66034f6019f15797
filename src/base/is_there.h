// Whether a file or folder is there, or whether that cannot be known.
#pragma once

#include <filesystem>
#include <string>

#include "livecap/error.h"

namespace livecap {

// False only where nothing is. Throws IoError where that may not be looked at: a folder without permission is not
// empty.
inline bool is_there(const std::filesystem::path& path) {
  std::error_code code;
  const bool there = std::filesystem::exists(path, code);
  if (code) throw IoError(path.string() + ": cannot be read: " + code.message());
  return there;
}

}  // namespace livecap
