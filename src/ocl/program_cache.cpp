#include "ocl/program_cache.h"

#include <cstdlib>
#include <fstream>
#include <vector>

#include "base/log.h"
#include "base/text.h"

namespace livecap::ocl {
namespace {

constexpr const char* kFormatVersion = "livecap-program-1";

// FNV-1a, 64 bit, from two offsets: a file name, not a signature.
uint64_t fnv1a(const std::string& text, uint64_t hash) {
  for (unsigned char c : text) {
    hash ^= c;
    hash *= 1099511628211ull;
  }
  return hash;
}

std::filesystem::path cache_folder() {
  if (const char* folder = std::getenv("LIVECAP_CACHE_DIR")) return folder;
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
    return std::filesystem::path(folder) / "livecap";
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache" / "livecap";
  return {};
}

}  // namespace

std::filesystem::path program_cache_file(const std::string& source, const std::string& options,
                                         const DeviceInfo& device) {
  const std::filesystem::path folder = cache_folder();
  if (folder.empty()) return {};
  std::string key;
  for (const std::string& part : {std::string(kFormatVersion), source, options, device.device_name,
                                  device.driver_version, device.platform_name, device.platform_version})
    key += part + '\0';
  return folder / format("%016llx%016llx.bin", static_cast<unsigned long long>(fnv1a(key, 14695981039346656037ull)),
                         static_cast<unsigned long long>(fnv1a(key, 1099511628211ull)));
}

cl_program load_cached_program(const std::filesystem::path& file, cl_context context, cl_device_id device,
                               const std::string& options) {
  std::error_code code;
  if (file.empty() || !std::filesystem::is_regular_file(file, code)) return nullptr;
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (!in && !in.eof()) return nullptr;
  if (bytes.empty()) return nullptr;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const size_t size = bytes.size();
  cl_int status = CL_SUCCESS;
  cl_int binary_status = CL_SUCCESS;
  cl_program program = clCreateProgramWithBinary(context, 1, &device, &size, &data, &binary_status, &status);
  if (status == CL_SUCCESS && binary_status == CL_SUCCESS &&
      clBuildProgram(program, 1, &device, options.c_str(), nullptr, nullptr) == CL_SUCCESS)
    return program;
  if (program) clReleaseProgram(program);
  std::filesystem::remove(file, code);
  return nullptr;
}

void store_cached_program(const std::filesystem::path& file, cl_program program) noexcept {
  if (file.empty()) return;
  try {
    size_t size = 0;
    if (clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof(size), &size, nullptr) != CL_SUCCESS || size == 0)
      return;
    std::string bytes(size, '\0');
    unsigned char* data = reinterpret_cast<unsigned char*>(bytes.data());
    if (clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof(data), &data, nullptr) != CL_SUCCESS) return;
    std::filesystem::create_directories(file.parent_path());
    write_file_atomically(file, bytes);
  } catch (const std::exception& e) {
    log_debug(std::string("program cache: ") + e.what());
  }
}

void mark_compiled_program(const std::filesystem::path& file) noexcept {
  if (file.empty()) return;
  try {
    std::filesystem::create_directories(file.parent_path());
    write_file_atomically(file, "");
  } catch (const std::exception& e) {
    log_debug(std::string("program cache: ") + e.what());
  }
}

bool is_compiled_program(const std::filesystem::path& file) noexcept {
  std::error_code code;
  return !file.empty() && std::filesystem::is_regular_file(file, code);
}

}  // namespace livecap::ocl
