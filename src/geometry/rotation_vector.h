#pragma once

#include <Eigen/Geometry>

namespace livecap {

// By |w| rad about w.
inline Eigen::Quaterniond rotation_of(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  return angle > 1e-12 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, w / angle)) : Eigen::Quaterniond::Identity();
}

}  // namespace livecap
