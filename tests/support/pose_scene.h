// Random true poses of the test actor and the exact detections a perfect network would give for them.
#pragma once

#include <random>
#include <string>

#include "base/detections.h"
#include "livecap/camera.h"
#include "pose/targets.h"
#include "support/test_actor.h"

namespace livecap::test {

inline Camera portrait_camera() {
  Camera camera;
  camera.width = 540;
  camera.height = 960;
  camera.fx = 800;
  camera.fy = 805;
  camera.cx = 268;
  camera.cy = 481;
  return camera;
}

// Upright person turned by `facing_rad` about the vertical, in front of the camera; angles at `share` of the range
// around zero.
inline Pose standing_pose(const Actor& actor, double facing_rad) {
  Pose pose = rest_pose(actor.skeleton);
  Eigen::Matrix3d upright;
  upright << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  pose.root_rotation = upright * Eigen::AngleAxisd(facing_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.root_translation_mm = {30, 20, 3200};
  return pose;
}

// Both thighs turned about x by hips_rad (negative: forward) and both shins by knees_rad (positive: back).
inline Pose with_bent_legs(const Actor& actor, Pose pose, double hips_rad, double knees_rad) {
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name.ends_with("_hip_x")) pose.angles_rad[k] += hips_rad;
    if (name.ends_with("_knee_x")) pose.angles_rad[k] += knees_rad;
  }
  return pose;
}

// A pose within the joint limits: every angle uniform in the middle `share` of its range.
inline Pose random_true_pose(const Actor& actor, std::mt19937& rng, double share) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Pose pose = standing_pose(actor, 1.2 * uniform(rng));
  pose.root_rotation =
      rotation_from_vector(0.2 * Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng))) * pose.root_rotation;
  pose.root_translation_mm += Eigen::Vector3d(100 * uniform(rng), 50 * uniform(rng), 300 * uniform(rng));
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const Dof& dof = actor.skeleton.dofs[k];
    pose.angles_rad[k] = 0.5 * (dof.min_rad + dof.max_rad) + 0.5 * share * uniform(rng) * (dof.max_rad - dof.min_rad);
  }
  return pose;
}

inline Pose disturbed(const Pose& pose, std::mt19937& rng, double angle_rad, double move_mm) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd delta =
      Eigen::VectorXd::NullaryExpr(6 + pose.angles_rad.size(), [&] { return angle_rad * uniform(rng); });
  for (int i = 3; i < 6; ++i) delta[i] = move_mm * uniform(rng);
  return add_increment(pose, delta);
}

// 3D relative to the pelvis keypoint, scaled by `scale`.
inline Detections exact_detections(const Actor& actor, const Camera& camera, const Pose& pose, double scale = 1) {
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  Detections detections;
  detections.person = true;
  detections.score = 1;
  for (int k = 0; k < kKeypointCount; ++k) {
    const Eigen::Vector3d& p = positions[k];
    const Eigen::Vector3d local = scale * (p - positions[kPelvis]);
    detections.keypoints[k] = {float(camera.fx * p.x() / p.z() + camera.cx),
                               float(camera.fy * p.y() / p.z() + camera.cy),
                               float(local.x()),
                               float(local.y()),
                               float(local.z()),
                               1.0f};
  }
  return detections;
}

// Largest distance between keypoints of two poses, mm.
inline double keypoint_distance_mm(const Actor& actor, const Pose& a, const Pose& b) {
  const auto pa = keypoint_positions(actor, forward_kinematics(actor.skeleton, a));
  const auto pb = keypoint_positions(actor, forward_kinematics(actor.skeleton, b));
  double largest = 0;
  for (int k = 0; k < kKeypointCount; ++k) largest = std::max(largest, (pa[k] - pb[k]).norm());
  return largest;
}

}  // namespace livecap::test
