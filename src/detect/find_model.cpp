#include "detect/find_model.h"

#include <dlfcn.h>
#include <link.h>

#include <cstdlib>
#include <vector>

#include "livecap/error.h"

namespace livecap::detect {
namespace {

namespace fs = std::filesystem;

// The file that this code was loaded from: the program, or a shared library in somebody else's. Empty when not known.
fs::path own_file() {
  std::error_code code;
  Dl_info info;
  void* map = nullptr;
  const bool found = ::dladdr1(reinterpret_cast<const void*>(&own_file), &info, &map, RTLD_DL_LINKMAP) != 0 && map;
  const char* library = found ? static_cast<const link_map*>(map)->l_name : "";  // the program's is empty
  const fs::path file = *library ? fs::canonical(library, code) : fs::read_symlink("/proc/self/exe", code);
  return code ? fs::path() : file;
}

}  // namespace

std::filesystem::path find_model(const std::string& model) {
  std::error_code code;
  if (model != "lite" && model != "full" && model != "heavy") {
    if (model.empty() || !fs::exists(model, code))
      throw IoError("network model \"" + model +
                    "\": no such file (give lite, full, heavy or the path of a .tflite file)");
    return model;
  }
  const std::string name = "pose_landmark_" + model + ".tflite";
  std::vector<fs::path> folders;
  if (const char* folder = std::getenv("LIVECAP_MODEL_DIR"); folder && *folder) {
    folders.push_back(folder);
  } else {
    const fs::path file = own_file();
    const fs::path prefix = file.parent_path().parent_path();
    // Above bin or lib, and above lib/x86_64-linux-gnu.
    if (!file.empty()) folders = {prefix / "share/livecap/models", prefix.parent_path() / "share/livecap/models"};
    folders.push_back(LIVECAP_SOURCE_MODEL_DIR);
  }
  std::string places;
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / name, code)) return folder / name;
    places.append(" ").append(folder.string());
  }
  throw IoError("network model \"" + model + "\": " + name + " is not in" + places +
                "; run tools/setup.sh, or set LIVECAP_MODEL_DIR");
}

}  // namespace livecap::detect
