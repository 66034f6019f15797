// The point of a segment nearest to another.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace livecap {

// How far along the segment from a (0) to b (1) it lies; 0 where a is b.
inline double segment_parameter(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  return length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
}

}  // namespace livecap
