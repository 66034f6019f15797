// The floor in files: camera.json, where somebody has measured it, and report.json, where a capture had it.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "livecap/camera.h"

namespace livecap {

// What is wrong with a floor that cannot be (Camera::validate), naming the field; empty: nothing.
std::string fault_of(const FloorPlane& floor);

// {"normal": [x, y, z], "distance_mm": d}. floor_from_json throws IoError naming `file` and field "floor" when the
// value is something else, and for a floor that cannot be.
FloorPlane floor_from_json(const nlohmann::json& value, const std::string& file);
nlohmann::ordered_json floor_json(const FloorPlane& floor);

// Of a camera.json or of a capture's report.json. Throws IoError naming the file, also when it tells none.
FloorPlane load_floor(const std::filesystem::path& path);

}  // namespace livecap
