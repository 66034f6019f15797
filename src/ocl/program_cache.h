// Built programs on disk: hash of everything the binary depends on, temporary file, rename; any fault means "not
// cached". Folder: LIVECAP_CACHE_DIR, else XDG_CACHE_HOME/livecap, else ~/.cache/livecap. Nothing is cached when none
// is writable.
#pragma once

#include <CL/cl.h>

#include <filesystem>
#include <string>

#include "ocl/device.h"

namespace livecap::ocl {

// Empty when there is no cache folder.
std::filesystem::path program_cache_file(const std::string& source, const std::string& options,
                                         const DeviceInfo& device);

// nullptr unless the file holds a binary that this device accepts and builds.
cl_program load_cached_program(const std::filesystem::path& file, cl_context context, cl_device_id device,
                               const std::string& options);

// Never throws; a failure leaves the cache as it was.
void store_cached_program(const std::filesystem::path& file, cl_program program) noexcept;

// PoCL caches what it builds from source itself. Asked for a binary it would compile every kernel once more for any
// work-group size, which no launch uses: half of the time of a first run. So an empty file stands for its binary, and
// later runs are not announced as the first.
void mark_compiled_program(const std::filesystem::path& file) noexcept;
bool is_compiled_program(const std::filesystem::path& file) noexcept;

}  // namespace livecap::ocl
