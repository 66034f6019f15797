#include "detect/find_model.h"

#include <cstdlib>
#include <vector>

#include "livecap/error.h"

namespace livecap::detect {

std::filesystem::path find_model(const std::string& model) {
  namespace fs = std::filesystem;
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
    const fs::path program = fs::read_symlink("/proc/self/exe", code);
    if (!code) folders.push_back(program.parent_path().parent_path() / "share/livecap/models");
    folders.push_back(LIVECAP_SOURCE_MODEL_DIR);
  }
  std::string places;
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / name, code)) return folder / name;
    places += " " + folder.string();
  }
  throw IoError("network model \"" + model + "\": " + name + " is not in" + places +
                "; run tools/setup.sh, or set LIVECAP_MODEL_DIR");
}

}  // namespace livecap::detect
