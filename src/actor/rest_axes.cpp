#include "actor/rest_axes.h"

#include <Eigen/Geometry>

namespace livecap {

Eigen::Matrix3d nearest_axis_rotation(const Eigen::Matrix3d& m) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  double best_score = -1e300;
  for (int x = 0; x < 6; ++x) {
    for (int y = 0; y < 6; ++y) {
      if (x % 3 == y % 3) continue;
      Eigen::Matrix3d r;
      r.col(0) = Eigen::Vector3d::Unit(x % 3) * (x < 3 ? 1 : -1);
      r.col(1) = Eigen::Vector3d::Unit(y % 3) * (y < 3 ? 1 : -1);
      r.col(2) = r.col(0).cross(r.col(1));
      if (const double score = (r.transpose() * m).trace(); score > best_score + 1e-12) {
        best_score = score;
        best = r;
      }
    }
  }
  return best;
}

std::optional<Eigen::Matrix3d> rest_from_file_axes(const RigPositions& at) {
  const Eigen::Vector3d up = (at[kRigNeck] - (at[kRigLeftHip] + at[kRigRightHip]) / 2).normalized();
  Eigen::Vector3d left =
      (at[kRigLeftHip] - at[kRigRightHip]).normalized() + (at[kRigLeftShoulder] - at[kRigRightShoulder]).normalized();
  left = (left - left.dot(up) * up).normalized();
  if (!(up.norm() > 0.5) || !(left.norm() > 0.5)) return {};  // neither of length 1, as they are otherwise
  Eigen::Matrix3d subject;
  subject << left, up, left.cross(up);
  return nearest_axis_rotation(subject).transpose();
}

}  // namespace livecap
