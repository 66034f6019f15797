#include "ocl/pocl_cache.h"

#include <unistd.h>

#include <cstdlib>

#include "base/log.h"
#include "base/scratch_folder.h"
#include "livecap/error.h"

namespace livecap::ocl {
namespace {

namespace fs = std::filesystem;

// A folder that is there, or can be made in the first one above that is.
bool can_be_written(fs::path folder) {
  std::error_code error;
  folder = fs::absolute(folder, error);
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  return fs::is_directory(folder, error) && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

}  // namespace

fs::path pocl_cache_folder() {
  if (const char* folder = std::getenv("POCL_CACHE_DIR")) return folder;
  const fs::path kernels = fs::path("pocl") / "kcache";
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return cache / kernels;
  if (const char* home = std::getenv("HOME")) return fs::path(home) / ".cache" / kernels;
  return "/tmp" / kernels;
}

void require_pocl_cache() {
  const fs::path folder = pocl_cache_folder();
  if (std::getenv("POCL_CACHE_DIR") || can_be_written(folder)) return;
  try {
    static const ScratchFolder scratch;
    ::setenv("POCL_CACHE_DIR", scratch.path().c_str(), 0);
    log_warning(folder.string() + ": cannot be written, so PoCL builds all kernels anew; see POCL_CACHE_DIR");
  } catch (const IoError&) {
    // Nothing can be written anywhere: the complaint says so.
  }
}

std::string pocl_cache_complaint() {
  const fs::path folder = pocl_cache_folder();
  return can_be_written(folder) ? "" : folder.string() + ", where PoCL keeps its kernels, cannot be written";
}

}  // namespace livecap::ocl
