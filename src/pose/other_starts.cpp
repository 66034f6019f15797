#include "pose/other_starts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pose/initialize.h"
#include "pose/targets.h"

namespace livecap {
namespace {

struct Leg {
  Keypoint ankle;
  const char* hip;
};

constexpr Leg kLegs[] = {{kLeftAnkle, "left_hip"}, {kRightAnkle, "right_hip"}};
struct Forearm {
  Keypoint elbow, wrist, hand;
  const char *bone, *shoulder;
};

constexpr Forearm kForearms[] = {{kLeftElbow, kLeftWrist, kLeftHand, "left_elbow", "left_shoulder"},
                                 {kRightElbow, kRightWrist, kRightHand, "right_elbow", "right_shoulder"}};
constexpr int kTwists = 48;             // steps over the range of an upper arm's twist
constexpr double kSpareTwistRad = 0.3;  // an arm twisted to its limit is hardly ever right
constexpr float kTrusted = 0.5f;        // confidence of detections that may overrule the picture

// Whether the bone is one of these or hangs on one.
bool hangs_on(const Skeleton& skeleton, int bone, const std::vector<int>& these) {
  for (; bone >= 0; bone = skeleton.bones[bone].parent) {
    if (std::find(these.begin(), these.end(), bone) != these.end()) return true;
  }
  return false;
}

// The last joint angle of a bone; -1 when it has none.
int last_dof(const Skeleton& skeleton, int bone) {
  for (int k = skeleton.n_dofs() - 1; k >= 0; --k) {
    if (skeleton.dofs[k].bone == bone) return k;
  }
  return -1;
}

const Forearm& forearm_below(Keypoint elbow) {
  return kForearms[elbow == kLeftElbow ? 0 : 1];
}

// The upper arm's twist and the elbow's bend.
struct ArmDofs {
  int twist = -1, bend = -1;
};

ArmDofs arm_dofs(const Skeleton& skeleton, const Forearm& arm) {
  const int bone = skeleton.bone_index(arm.bone), shoulder = skeleton.bone_index(arm.shoulder);
  if (bone < 0 || shoulder < 0) return {};
  return {last_dof(skeleton, shoulder), last_dof(skeleton, bone)};
}

// `pose` with the wrist as near to `target` (camera frame, mm) as these two bring it.
Pose with_wrist_at(const Actor& actor, const Pose& pose, Keypoint wrist, ArmDofs dofs, const Eigen::Vector3d& target) {
  const Skeleton& skeleton = actor.skeleton;
  const auto [twist, bend] = dofs;
  const Dof &twists = skeleton.dofs[twist], &bends = skeleton.dofs[bend];
  const double low = twists.min_rad + kSpareTwistRad, high = twists.max_rad - kSpareTwistRad;
  Pose best = pose;
  double best_mm = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kTwists; ++i) {
    Pose bent = pose;
    bent.angles_rad[twist] = low + (high - low) * i / kTwists;
    const PosedSkeleton posed = forward_kinematics(skeleton, bent);
    const Eigen::Vector3d& axis = posed.dof_axis[bend];
    const Eigen::Vector3d from = keypoint_positions(actor, posed)[wrist] - posed.dof_origin_mm[bend];
    const Eigen::Vector3d to = target - posed.dof_origin_mm[bend];
    const double turn = std::atan2(to.dot(axis.cross(from)), to.dot(from - axis * axis.dot(from)));
    const double angle = std::remainder(bent.angles_rad[bend] + turn, 2 * std::numbers::pi);
    bent.angles_rad[bend] = std::clamp(angle, bends.min_rad, bends.max_rad);
    const double mm = (keypoint_positions(actor, forward_kinematics(skeleton, bent))[wrist] - target).norm();
    if (mm >= best_mm) continue;
    best_mm = mm;
    best = bent;
  }
  return best;
}

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

std::optional<Pose> with_detected_legs(const Actor& actor, const Camera& camera, const Pose& pose,
                                       const Detections& detections, const PoseOptions& options, double least_px) {
  if (!detections.person) return std::nullopt;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  std::vector<int> strayed;  // hips
  for (const Leg& leg : kLegs) {
    const KeypointDetection& seen = detections.keypoints[leg.ankle];
    const Eigen::Vector3d& p = positions[leg.ankle];
    const int hip = actor.skeleton.bone_index(leg.hip);
    if (hip < 0 || actor.keypoints[leg.ankle].bone < 0 || !(p.z() > 0) || !(seen.confidence >= kTrusted)) continue;
    const double distance = (project_px(camera, p) - Eigen::Vector2d(seen.x_px, seen.y_px)).norm();
    if (distance >= least_px) strayed.push_back(hip);
  }
  if (strayed.empty()) return std::nullopt;
  const std::optional<Pose> found = initialize_pose(actor, camera, detections, options);
  if (!found) return std::nullopt;
  Pose bent = pose;
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    if (hangs_on(actor.skeleton, actor.skeleton.dofs[k].bone, strayed)) bent.angles_rad[k] = found->angles_rad[k];
  }
  return bent;
}

std::optional<MirroredForearm> mirrored_forearm(const Actor& actor, const Pose& pose, Keypoint elbow_name,
                                                double least_turn_rad) {
  const Forearm& arm = forearm_below(elbow_name);
  const ArmDofs dofs = arm_dofs(actor.skeleton, arm);
  if (dofs.twist < 0 || dofs.bend < 0 || actor.keypoints[arm.elbow].bone < 0 || actor.keypoints[arm.wrist].bone < 0)
    return std::nullopt;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  const Eigen::Vector3d &elbow = positions[arm.elbow], &wrist = positions[arm.wrist];
  const Eigen::Vector3d ray = wrist.normalized();
  const Eigen::Vector3d mirrored = (2 * elbow.dot(ray) - wrist.norm()) * ray - elbow;
  const auto turn = Eigen::Quaterniond::FromTwoVectors(wrist - elbow, mirrored);
  if (!(Eigen::AngleAxisd(turn).angle() >= least_turn_rad)) return std::nullopt;
  return MirroredForearm{elbow_name, actor.skeleton.bone_index(arm.bone), turn.toRotationMatrix(), elbow + mirrored};
}

Pose with_mirrored_forearm(const Actor& actor, const Pose& pose, const MirroredForearm& mirrored) {
  const Forearm& arm = forearm_below(mirrored.elbow);
  return with_wrist_at(actor, pose, arm.wrist, arm_dofs(actor.skeleton, arm), mirrored.wrist_mm);
}

std::optional<Pose> with_hinges_bent_back(const Skeleton& skeleton, const Pose& pose, double least_rad) {
  std::vector<int> n_angles(skeleton.n_bones(), 0);
  for (const Dof& dof : skeleton.dofs) ++n_angles[dof.bone];
  Pose bent = pose;
  bool any = false;
  for (int k = 0; k < skeleton.n_dofs(); ++k) {
    const Dof& dof = skeleton.dofs[k];
    const double limit = std::clamp(pose.angles_rad[k], dof.min_rad, dof.max_rad);
    if (n_angles[dof.bone] != 1 || !(std::abs(pose.angles_rad[k] - limit) >= least_rad)) continue;
    bent.angles_rad[k] = std::clamp(2 * limit - pose.angles_rad[k], dof.min_rad, dof.max_rad);
    any = true;
  }
  return any ? std::optional(bent) : std::nullopt;
}

}  // namespace livecap
