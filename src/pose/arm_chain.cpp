#include "pose/arm_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pose/targets.h"

namespace livecap {
namespace {

struct ArmNames {
  Keypoint shoulder, elbow, wrist;
  const char *upper, *lower;
};

constexpr ArmNames kArms[] = {{kLeftShoulder, kLeftElbow, kLeftWrist, "left_shoulder", "left_elbow"},
                              {kRightShoulder, kRightElbow, kRightWrist, "right_shoulder", "right_elbow"}};
constexpr int kTwists = 48;             // steps over the range of an upper arm's twist
constexpr double kSpareTwistRad = 0.3;  // an arm twisted to its limit is hardly ever right
constexpr int kElbowSweeps = 20;

// Turns one joint angle so that the keypoint comes as near to `target` (camera frame, mm) as it can, or to its limit on
// the way there.
void turn_towards(const Actor& actor, int dof, Keypoint keypoint, const Eigen::Vector3d& target, Pose& pose) {
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
  const Eigen::Vector3d& axis = posed.dof_axis[dof];
  const Eigen::Vector3d from = keypoint_positions(actor, posed)[keypoint] - posed.dof_origin_mm[dof];
  const Eigen::Vector3d to = target - posed.dof_origin_mm[dof];
  const double turn = std::atan2(to.dot(axis.cross(from)), to.dot(from - axis * axis.dot(from)));
  const Dof& limits = actor.skeleton.dofs[dof];
  const double angle = std::remainder(pose.angles_rad[dof] + turn, 2 * std::numbers::pi);
  pose.angles_rad[dof] = std::clamp(angle, limits.min_rad, limits.max_rad);
}

}  // namespace

std::optional<ArmChain> arm_chain(const Actor& actor, Keypoint elbow) {
  const ArmNames& names = kArms[elbow == kLeftElbow ? 0 : 1];
  const Skeleton& skeleton = actor.skeleton;
  ArmChain arm{names.shoulder,
               names.elbow,
               names.wrist,
               skeleton.bone_index(names.upper),
               skeleton.bone_index(names.lower),
               {},
               -1,
               -1};
  for (int k = 0; k < skeleton.n_dofs(); ++k) {
    if (skeleton.dofs[k].bone == arm.upper) arm.aims.push_back(k);
    if (skeleton.dofs[k].bone == arm.lower) arm.bend = k;
  }
  if (arm.upper < 0 || arm.bend < 0 || arm.aims.empty() || actor.keypoints[arm.elbow].bone < 0 ||
      actor.keypoints[arm.wrist].bone < 0)
    return std::nullopt;
  arm.twist = arm.aims.back();
  arm.aims.pop_back();
  return arm;
}

Pose with_elbow_at(const Actor& actor, const ArmChain& arm, Pose pose, const Eigen::Vector3d& target) {
  for (int sweep = 0; sweep < kElbowSweeps; ++sweep)
    for (int dof : arm.aims) turn_towards(actor, dof, arm.elbow, target, pose);
  return pose;
}

Pose with_wrist_at(const Actor& actor, const ArmChain& arm, const Pose& pose, const Eigen::Vector3d& target) {
  const Dof& twists = actor.skeleton.dofs[arm.twist];
  const double low = twists.min_rad + kSpareTwistRad, high = twists.max_rad - kSpareTwistRad;
  Pose best = pose;
  double best_mm = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kTwists; ++i) {
    Pose bent = pose;
    bent.angles_rad[arm.twist] = low + (high - low) * i / kTwists;
    turn_towards(actor, arm.bend, arm.wrist, target, bent);
    const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, bent));
    const double mm = (positions[arm.wrist] - target).norm();
    if (mm >= best_mm) continue;
    best_mm = mm;
    best = bent;
  }
  return best;
}

}  // namespace livecap
