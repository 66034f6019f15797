// A second calibrated camera that did not take part in the capture: how well the captured surface fits what it saw.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "eval/metrics.h"
#include "livecap/camera.h"

namespace livecap {

// camera.json with one more field: "view_from_camera": [[r,r,r,t],[r,r,r,t],[r,r,r,t]], a rotation and a translation in
// mm that take a point from the capturing camera's frame to this one's, both with OpenCV's axes.
struct ExtraView {
  std::string name;             // of the camera file
  std::filesystem::path masks;  // %06d.png like those of the truth
  Camera camera;
  Eigen::Isometry3d view_from_camera = Eigen::Isometry3d::Identity();
};

// Throws IoError naming the file and the field, also when the matrix is no rotation.
ExtraView open_view(const std::filesystem::path& camera, const std::filesystem::path& masks);

// [3*n] mm, capturing camera's frame -> the view's.
std::vector<float> to_view(const ExtraView& view, std::span<const float> positions_mm);

}  // namespace livecap
