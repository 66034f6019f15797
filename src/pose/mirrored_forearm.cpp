#include "pose/mirrored_forearm.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/shortest_turn.h"
#include "pose/arm_points.h"
#include "pose/targets.h"

namespace livecap {
namespace {

constexpr int kTwists = 48;             // steps over the range of an upper arm's twist
constexpr double kSpareTwistRad = 0.3;  // an arm twisted to its limit is hardly ever right

struct Arm {
  Keypoint elbow, wrist;
  int lower;        // bone
  int twist, bend;  // angles: the upper arm's last, the elbow's
};

std::optional<Arm> find_arm(const Actor& actor, Keypoint elbow) {
  const ArmPoints& points = kArmPoints[elbow == kLeftElbow ? 0 : 1];
  const Skeleton& skeleton = actor.skeleton;
  const int upper = skeleton.bone_index(points.shoulder);
  Arm arm{elbow, points.wrist, skeleton.bone_index(points.forearm), -1, -1};
  for (int k = 0; k < skeleton.n_dofs(); ++k) {
    if (skeleton.dofs[k].bone == upper) arm.twist = k;
    if (skeleton.dofs[k].bone == arm.lower) arm.bend = k;
  }
  const bool has_both = actor.keypoints[arm.elbow].bone >= 0 && actor.keypoints[arm.wrist].bone >= 0;
  return arm.twist >= 0 && arm.bend >= 0 && has_both ? std::optional(arm) : std::nullopt;
}

// The other point on the ray of `end` that is as far from `start`.
Eigen::Vector3d mirrored_end(const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  const Eigen::Vector3d ray = end.normalized();
  return (2 * start.dot(ray) - end.norm()) * ray;
}

// Bends the elbow so that the wrist comes as near to `target` (camera frame, mm) as it can, or to its limit on the way
// there.
void bend_towards(const Actor& actor, const Arm& arm, const Eigen::Vector3d& target, Pose& pose) {
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
  const Eigen::Vector3d& axis = posed.dof_axis[arm.bend];
  const Eigen::Vector3d from = keypoint_positions(actor, posed)[arm.wrist] - posed.dof_origin_mm[arm.bend];
  const Eigen::Vector3d to = target - posed.dof_origin_mm[arm.bend];
  const double turn = std::atan2(to.dot(axis.cross(from)), to.dot(from - axis * axis.dot(from)));
  const Dof& limits = actor.skeleton.dofs[arm.bend];
  const double angle = std::remainder(pose.angles_rad[arm.bend] + turn, 2 * std::numbers::pi);
  pose.angles_rad[arm.bend] = std::clamp(angle, limits.min_rad, limits.max_rad);
}

}  // namespace

std::optional<MirroredForearm> mirrored_forearm(const Actor& actor, const Pose& pose, Keypoint elbow_name,
                                                double least_turn_rad) {
  const std::optional<Arm> arm = find_arm(actor, elbow_name);
  if (!arm) return std::nullopt;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  const Eigen::Vector3d &elbow = positions[arm->elbow], &wrist = positions[arm->wrist];
  const Eigen::Vector3d mirrored = mirrored_end(elbow, wrist);
  const Eigen::Quaterniond turn = shortest_turn(wrist - elbow, mirrored - elbow);
  if (!(Eigen::AngleAxisd(turn).angle() >= least_turn_rad)) return std::nullopt;
  return MirroredForearm{elbow_name, arm->lower, turn.toRotationMatrix(), mirrored};
}

Pose with_mirrored_forearm(const Actor& actor, const Pose& pose, const MirroredForearm& mirrored) {
  const std::optional<Arm> arm = find_arm(actor, mirrored.elbow);
  if (!arm) return pose;
  const Dof& twists = actor.skeleton.dofs[arm->twist];
  const double low = twists.min_rad + kSpareTwistRad, high = twists.max_rad - kSpareTwistRad;
  Pose best = pose;
  double best_mm = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kTwists; ++i) {
    Pose bent = pose;
    bent.angles_rad[arm->twist] = low + (high - low) * i / kTwists;
    bend_towards(actor, *arm, mirrored.wrist_mm, bent);
    const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, bent));
    const double mm = (positions[arm->wrist] - mirrored.wrist_mm).norm();
    if (mm >= best_mm) continue;
    best_mm = mm;
    best = bent;
  }
  return best;
}

}  // namespace livecap
