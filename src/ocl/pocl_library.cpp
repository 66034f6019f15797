#include "ocl/pocl_library.h"

#include <dlfcn.h>
#include <link.h>

#include <cctype>
#include <cstdlib>
#include <fstream>

namespace livecap::ocl {
namespace {

constexpr int kRenamedMajor = 2;
constexpr int kRenamedMinor = 11;

// The library's real file, links resolved. The loader opens it by the same name a moment later, so it stays open.
std::filesystem::path library_file(const std::string& name) {
  void* library = dlopen(name.c_str(), RTLD_LAZY | RTLD_LOCAL);
  link_map* map = nullptr;
  if (!library || dlinfo(library, RTLD_DI_LINKMAP, &map) != 0 || !map) return {};
  std::error_code code;
  const std::filesystem::path file = std::filesystem::canonical(map->l_name, code);
  return code ? std::filesystem::path(map->l_name) : file;
}

// Reads digits from `text` at `at` on; -1 when there are none.
int take_number(const std::string& text, size_t& at) {
  if (at >= text.size() || !std::isdigit(static_cast<unsigned char>(text[at]))) return -1;
  int value = 0;
  for (; at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) && value < 100000; ++at)
    value = 10 * value + (text[at] - '0');
  return value;
}

}  // namespace

std::string one_core_driver_of(const std::filesystem::path& library) {
  const std::string name = library.filename().string();
  size_t at = name.find(".so.");
  if (name.find("pocl") == std::string::npos || at == std::string::npos) return {};
  at += 4;
  const int major = take_number(name, at);
  if (major < 0 || at >= name.size() || name[at] != '.') return {};
  const int minor = take_number(name, ++at);
  if (minor < 0) return {};
  const bool renamed = major > kRenamedMajor || (major == kRenamedMajor && minor >= kRenamedMinor);
  return renamed ? "cpu-minimal" : "basic";
}

std::string one_core_driver(const std::vector<std::filesystem::path>& folders) {
  for (const auto& folder : folders) {
    std::error_code code;
    for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
      if (entry.path().extension() != ".icd") continue;
      std::string library;
      std::ifstream(entry.path()) >> library;
      if (library.find("pocl") == std::string::npos) continue;
      std::string driver = one_core_driver_of(library_file(library));
      if (driver.empty()) driver = one_core_driver_of(library);
      if (!driver.empty()) return driver;
    }
  }
  return {};
}

std::vector<std::filesystem::path> icd_folders() {
  if (const char* folder = std::getenv("OCL_ICD_VENDORS"); folder && *folder) return {folder};
  return {"/etc/OpenCL/vendors"};
}

}  // namespace livecap::ocl
