// Where the cameras of a set of pictures stood, from the files other tools write: COLMAP's text model (cameras.txt,
// images.txt), OpenCV's YAML, XML or JSON, or a Skeletool calibration (docs/actor_build.md).
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "livecap/camera.h"

namespace livecap {

struct ViewPose {
  std::string picture;  // file name
  Camera camera;        // OpenCV pixel convention, with distortion
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
};

// COLMAP's text model: whether `folder` has cameras.txt and images.txt.
bool is_colmap_model(const std::filesystem::path& folder);

// path: a folder with cameras.txt and images.txt, a Skeletool calibration (whose cameras are given the pictures of the
// folder `pictures` by name), or a file read by OpenCV's FileStorage. Sorted by picture. Throws IoError naming file,
// line or view, and what would be right.
std::vector<ViewPose> read_view_poses(const std::filesystem::path& path, const std::filesystem::path& pictures = {});

// Where they are when nobody says: the first of PICTURES, PICTURES/.., PICTURES/../sparse/0 and PICTURES/../sparse that
// has a COLMAP text model or, looked for in this order, cameras.yml, .yaml, .json, .xml or .calibration. Throws
// ConfigError listing what was looked for.
std::filesystem::path find_view_poses(const std::filesystem::path& pictures);

}  // namespace livecap
