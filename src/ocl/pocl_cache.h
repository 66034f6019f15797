// PoCL keeps the kernels it built in a folder, and has no device where it cannot write there: an account without a home
// folder would look like a machine without a driver.
#pragma once

#include <filesystem>
#include <string>

namespace livecap::ocl {

// POCL_CACHE_DIR, else PoCL's own choice below XDG_CACHE_HOME or HOME.
std::filesystem::path pocl_cache_folder();

// Where it can be neither written to nor made, sets POCL_CACHE_DIR to a folder that goes away with the process, and
// warns. One that the user has set stays. To be called before the first OpenCL call.
void require_pocl_cache();

// For a message that no device was found; empty where the folder is not the reason.
std::string pocl_cache_complaint();

}  // namespace livecap::ocl
