#include "pose/mirrored_arms.h"

#include <Eigen/Geometry>
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

struct Arm {
  Keypoint shoulder, elbow, wrist;
  int upper, lower;       // bones
  std::vector<int> aims;  // angles of the upper arm but its twist
  int twist, bend;        // angles
};

std::optional<Arm> arm_of(const Actor& actor, Keypoint elbow) {
  const ArmNames& names = kArms[elbow == kLeftElbow ? 0 : 1];
  const Skeleton& skeleton = actor.skeleton;
  Arm arm{names.shoulder,
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

// `pose` with the wrist as near to `target` as the upper arm's twist and the elbow's bend bring it.
Pose with_wrist_at(const Actor& actor, const Arm& arm, const Pose& pose, const Eigen::Vector3d& target) {
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
  const std::optional<Arm> arm = arm_of(actor, elbow_name);
  if (!arm) return std::nullopt;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  const Eigen::Vector3d &elbow = positions[arm->elbow], &wrist = positions[arm->wrist];
  const Eigen::Vector3d mirrored = mirrored_end(elbow, wrist);
  const auto turn = Eigen::Quaterniond::FromTwoVectors(wrist - elbow, mirrored - elbow);
  if (!(Eigen::AngleAxisd(turn).angle() >= least_turn_rad)) return std::nullopt;
  return MirroredForearm{elbow_name, arm->lower, turn.toRotationMatrix(), mirrored};
}

Pose with_mirrored_forearm(const Actor& actor, const Pose& pose, const MirroredForearm& mirrored) {
  const std::optional<Arm> arm = arm_of(actor, mirrored.elbow);
  return arm ? with_wrist_at(actor, *arm, pose, mirrored.wrist_mm) : pose;
}

std::vector<Pose> mirrored_arms(const Actor& actor, const Pose& pose, Keypoint elbow_name, const Detections& detections,
                                const PoseOptions& options, const MirroredArmOptions& mirrored) {
  const std::optional<Arm> arm = arm_of(actor, elbow_name);
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
    Pose bent = pose;
    const Eigen::Vector3d new_elbow = turn_upper ? mirrored_end(shoulder, elbow) : elbow;
    for (int sweep = 0; turn_upper && sweep < kElbowSweeps; ++sweep)
      for (int dof : arm->aims) turn_towards(actor, dof, arm->elbow, new_elbow, bent);
    const bool farther = (wrist.norm() > elbow.dot(wrist.normalized())) != turn_lower;
    poses.push_back(with_wrist_at(actor, *arm, bent, on_ray(new_elbow, wrist, (wrist - elbow).norm(), farther)));
  }
  return poses;
}

}  // namespace livecap
