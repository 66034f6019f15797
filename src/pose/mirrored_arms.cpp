#include "pose/mirrored_arms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pose/arm_chain.h"
#include "pose/targets.h"

namespace livecap {
namespace {

// The point on the ray of `end` that is `length` from `start`, or as near to that as one is: the farther of the two
// from the camera, or the nearer.
Eigen::Vector3d on_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& end, double length, bool farther) {
  const Eigen::Vector3d ray = end.normalized();
  const double middle = start.dot(ray);
  const double reach = std::sqrt(std::max(0.0, length * length - (start - middle * ray).squaredNorm()));
  return (farther ? middle + reach : middle - reach) * ray;
}

// The same as `end`, mirrored.
Eigen::Vector3d mirrored_end(const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  return on_ray(start, end, (end - start).norm(), !(end.norm() > start.dot(end.normalized())));
}

}  // namespace

std::optional<MirroredForearm> mirrored_forearm(const Actor& actor, const Pose& pose, Keypoint elbow_name,
                                                double least_turn_rad) {
  const std::optional<ArmChain> arm = arm_chain(actor, elbow_name);
  if (!arm) return std::nullopt;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  const Eigen::Vector3d &elbow = positions[arm->elbow], &wrist = positions[arm->wrist];
  const Eigen::Vector3d mirrored = mirrored_end(elbow, wrist);
  const auto turn = Eigen::Quaterniond::FromTwoVectors(wrist - elbow, mirrored - elbow);
  if (!(Eigen::AngleAxisd(turn).angle() >= least_turn_rad)) return std::nullopt;
  return MirroredForearm{elbow_name, arm->lower, turn.toRotationMatrix(), mirrored};
}

Pose with_mirrored_forearm(const Actor& actor, const Pose& pose, const MirroredForearm& mirrored) {
  const std::optional<ArmChain> arm = arm_chain(actor, mirrored.elbow);
  return arm ? with_wrist_at(actor, *arm, pose, mirrored.wrist_mm) : pose;
}

std::vector<Pose> mirrored_arms(const Actor& actor, const Pose& pose, Keypoint elbow_name, const Detections& detections,
                                const PoseOptions& options, const MirroredArmOptions& mirrored) {
  const std::optional<ArmChain> arm = arm_chain(actor, elbow_name);
  if (!arm || actor.keypoints[arm->shoulder].bone < 0) return {};
  const Keypoints3d seen = detected_points(actor, detections, options);
  for (Keypoint k : {arm->shoulder, arm->elbow, arm->wrist})
    if (!(seen[k].confidence >= kTrustedDetection)) return {};
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  const Eigen::Vector3d &shoulder = positions[arm->shoulder], &elbow = positions[arm->elbow];
  const Eigen::Vector3d& wrist = positions[arm->wrist];
  const Eigen::Vector3d ray = elbow.normalized();
  const auto depth = [&](const Eigen::Vector3d& bone) { return bone.normalized().dot(ray); };
  const double upper = depth(elbow - shoulder), lower = depth(wrist - elbow);
  const double seen_upper = depth(seen[arm->elbow].position_mm - seen[arm->shoulder].position_mm);
  const double seen_lower = depth(seen[arm->wrist].position_mm - seen[arm->elbow].position_mm);
  const auto difference = [&](double u, double l) { return std::pow(u - seen_upper, 2) + std::pow(l - seen_lower, 2); };
  const double now = difference(upper, lower);
  if (!(now >= mirrored.least_difference)) return {};

  std::vector<Pose> poses;
  for (const auto& [turn_upper, turn_lower] : {std::pair{true, false}, {false, true}, {true, true}}) {
    if (!(difference(turn_upper ? -upper : upper, turn_lower ? -lower : lower) < mirrored.largest_share * now))
      continue;
    const Eigen::Vector3d new_elbow = turn_upper ? mirrored_end(shoulder, elbow) : elbow;
    const Pose bent = turn_upper ? with_elbow_at(actor, *arm, pose, new_elbow) : pose;
    const bool farther = (wrist.norm() > elbow.dot(wrist.normalized())) != turn_lower;
    poses.push_back(with_wrist_at(actor, *arm, bent, on_ray(new_elbow, wrist, (wrist - elbow).norm(), farther)));
  }
  return poses;
}

}  // namespace livecap
