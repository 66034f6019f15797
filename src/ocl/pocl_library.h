// Which PoCL the OpenCL loader will use. Needed before the first OpenCL call, when PoCL cannot be asked itself.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace livecap::ocl {

// PoCL's name of its one-core CPU driver for a library file such as ".../libpocl.so.2.12.0": "basic" up to PoCL 3.1
// (libpocl.so.2.10), "cpu-minimal" from PoCL 4.0 (libpocl.so.2.11) on. Empty when the file name has no such version.
std::string one_core_driver_of(const std::filesystem::path& library);

// The same for the PoCL that the *.icd files of a folder name; empty when none does or its version is unknown.
std::string one_core_driver(const std::vector<std::filesystem::path>& icd_folders);

// Where the loader looks: OCL_ICD_VENDORS when it is set, else /etc/OpenCL/vendors.
std::vector<std::filesystem::path> icd_folders();

}  // namespace livecap::ocl
