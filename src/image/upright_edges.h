// Which way is up, by a picture of a room: edges of walls, doors and shelves stand upright, and are seen to point to
// one place. Told before anybody has taken a step, and nearer than how people stand tells it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/image_rgb.h"
#include "livecap/camera.h"

namespace livecap {

struct Upright {
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  // unit, camera frame
  // Of a small turn that moves `up` by d: d^T information d are its squared deviations. 1/rad^2
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int n_edges = 0;  // that agree
};

// picture: undistorted, of the camera's size. person: nonzero = not of the room; may be empty. nullopt where too few
// edges agree. Up to 35 degrees up or down and 10 to a side. Throws LogicError for sizes that differ.
std::optional<Upright> upright_by_edges(const ImageRgb& picture, const ImageGray& person, const Camera& camera);

}  // namespace livecap
