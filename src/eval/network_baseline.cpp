#include "eval/network_baseline.h"

#include <Eigen/Dense>
#include <limits>

#include "pose/rebone.h"

namespace livecap {

std::vector<std::string> network_joint_names() {
  std::vector<std::string> names(kKeypointNames.begin(), kKeypointNames.end());
  names[kPelvis] = "root";
  return names;
}

std::vector<float> network_joints(const Actor& actor, const Camera& camera, const Detections& detections) {
  const Keypoints3d points = rebone(actor, detections);
  // u (z + t_z) = fx (x + t_x) and v (z + t_z) = fy (y + t_y), least squares, weighted by confidence.
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (int k = 0; k < kBodyKeypointCount; ++k) {
    if (!(points[k].confidence > 0)) continue;
    const Eigen::Vector3d& p = points[k].position_mm;
    const double u = detections.keypoints[k].x_px - camera.cx;
    const double v = detections.keypoints[k].y_px - camera.cy;
    const auto add_row = [&](const Eigen::Vector3d& row, double value) {
      A += points[k].confidence * row * row.transpose();
      b += points[k].confidence * value * row;
    };
    add_row({camera.fx, 0, -u}, u * p.z() - camera.fx * p.x());
    add_row({0, camera.fy, -v}, v * p.z() - camera.fy * p.y());
  }
  const Eigen::ColPivHouseholderQR<Eigen::Matrix3d> qr(A);
  if (qr.rank() < 3) return {};
  const Eigen::Vector3d translation = qr.solve(b);
  std::vector<float> joints;
  for (int k = 0; k < kKeypointCount; ++k) {
    const bool known = points[k].confidence > 0 || k == kPelvis;
    const Eigen::Vector3d placed = known ? Eigen::Vector3d(points[k].position_mm + translation)
                                         : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (int axis = 0; axis < 3; ++axis) joints.push_back(static_cast<float>(placed[axis]));
  }
  return joints;
}

}  // namespace livecap
