// From the library's frame (millimetres, camera axes: x right, y down, z forward) to that of every exported file (glTF:
// metres, Y up, right-handed). docs/conventions.md.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "geometry/shortest_turn.h"

namespace livecap {

inline constexpr double kMetresPerMm = 1e-3;

// Half a turn about x: a proper rotation, so that nothing is mirrored.
inline Eigen::Matrix3d gltf_axes_from_camera() {
  return Eigen::Vector3d(1, -1, -1).asDiagonal();
}

// The shortest turn, camera axes, after which `up` (unit) points straight up, which is -y there.
inline Eigen::Quaterniond upright_from_camera(const Eigen::Vector3d& up) {
  return shortest_turn(up, -Eigen::Vector3d::UnitY());
}

// The same turn in glTF's axes.
inline Eigen::Quaterniond gltf_turn_from_camera(const Eigen::Quaterniond& turn) {
  return {turn.w(), turn.x(), -turn.y(), -turn.z()};
}

inline Eigen::Vector3d gltf_from_camera(const Eigen::Vector3d& camera_mm) {
  return kMetresPerMm * Eigen::Vector3d(camera_mm.x(), -camera_mm.y(), -camera_mm.z());
}

// [3n] mm, camera -> [3n] metres, glTF.
inline std::vector<float> gltf_from_camera(std::span<const float> camera_mm) {
  std::vector<float> result(camera_mm.size());
  for (size_t i = 0; i < camera_mm.size(); ++i)
    result[i] = static_cast<float>((i % 3 == 0 ? 1 : -1) * kMetresPerMm * camera_mm[i]);
  return result;
}

}  // namespace livecap
