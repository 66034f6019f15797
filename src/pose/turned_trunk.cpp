#include "pose/turned_trunk.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pose/initialize.h"
#include "pose/targets.h"

namespace livecap {
namespace {

constexpr float kTrusted = 0.5f;  // confidence of detections that may overrule the picture

}  // namespace

std::optional<Pose> turned_trunk(const Actor& actor, const Pose& pose, const Detections& detections,
                                 const PoseOptions& options, double least_turn_rad) {
  for (int k : {kLeftHip, kRightHip, kLeftShoulder, kRightShoulder})
    if (!(detections.keypoints[k].confidence >= kTrusted)) return std::nullopt;
  const std::optional<Eigen::Matrix3d> detected = torso_rotation(actor, detections, options);
  if (!detected) return std::nullopt;
  const auto rest = keypoint_positions(actor, forward_kinematics(actor.skeleton, rest_pose(actor.skeleton)));
  const Eigen::Vector3d axis = (pose.root_rotation * (rest[kNeck] - rest[kPelvis])).normalized();
  // The twist of the difference about the axis.
  const Eigen::Quaterniond difference(*detected * pose.root_rotation.transpose());
  const double turn = std::remainder(2 * std::atan2(difference.vec().dot(axis), difference.w()), 2 * std::numbers::pi);
  if (!(std::abs(turn) >= least_turn_rad)) return std::nullopt;
  Pose turned = pose;
  turned.root_rotation = Eigen::AngleAxisd(turn, axis).toRotationMatrix() * pose.root_rotation;
  return turned;
}

}  // namespace livecap
