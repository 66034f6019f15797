// Where the network weights are; they are not part of the repository.
#pragma once

#include <filesystem>
#include <string>

namespace livecap::detect {

// model: "lite", "full", "heavy" (MediaPipe Pose), or a path to a .tflite file. The named ones are looked for as
// pose_landmark_<name>.tflite in LIVECAP_MODEL_DIR if set, else in ../share/livecap/models and
// ../../share/livecap/models of the folder that the program or shared library with this code is in, then in the source
// tree's models/. Throws IoError listing the places when it is nowhere.
std::filesystem::path find_model(const std::string& model);

}  // namespace livecap::detect
