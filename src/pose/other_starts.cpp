#include "pose/other_starts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "pose/arm_points.h"
#include "pose/floor.h"
#include "pose/initialize.h"
#include "pose/round_weights.h"
#include "pose/targets.h"

namespace livecap {
namespace {

struct LegBones {
  Keypoint ankle;
  const char* hip;
  const char* knee;
};

constexpr LegBones kLegBones[] = {{kLeftAnkle, "left_hip", "left_knee"}, {kRightAnkle, "right_hip", "right_knee"}};

// How far from rest a thigh swings forward, and its shin back.
struct Bend {
  double hip_rad, knee_rad;
};

constexpr Bend kStraight = {0, 0}, kSquat = {1.2, 1.6}, kStep = {0.6, 0.9};

// From the keypoint of a pose to its detection; 0 where it has none, or lies behind the camera.
double distance_px(const Actor& actor, const Camera& camera,
                   const std::array<Eigen::Vector3d, kKeypointCount>& positions, const Detections& detections,
                   Keypoint k) {
  if (actor.keypoints[k].bone < 0 || !(positions[k].z() > 0)) return 0;
  const KeypointDetection& seen = detections.keypoints[k];
  return (project_px(camera, positions[k]) - Eigen::Vector2d(seen.x_px, seen.y_px)).norm();
}

// `pose` with what hangs on the bone bent as in `found`.
Pose bent_as(const Skeleton& skeleton, const Pose& found, int bone, Pose pose) {
  for (int k = 0; k < skeleton.n_dofs(); ++k)
    if (hangs_on(skeleton, skeleton.dofs[k].bone, bone)) pose.angles_rad[k] = found.angles_rad[k];
  return pose;
}

}  // namespace

std::optional<Pose> turned_trunk(const Actor& actor, const Pose& pose, const Detections& detections,
                                 const PoseOptions& options, double least_turn_rad) {
  for (int k : {kLeftHip, kRightHip, kLeftShoulder, kRightShoulder})
    if (!(detections.keypoints[k].confidence >= kTrustedDetection)) return std::nullopt;
  const std::optional<Eigen::Matrix3d> detected = torso_rotation(actor, detections, options);
  const auto posed = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  const std::optional<Eigen::Matrix3d> own = torso_rotation(actor, posed);
  if (!detected || !own) return std::nullopt;
  const Eigen::Vector3d axis = (posed[kNeck] - posed[kPelvis]).normalized();
  // The twist of the difference about the axis.
  const Eigen::Quaterniond difference(*detected * own->transpose());
  const double turn = std::remainder(2 * std::atan2(difference.vec().dot(axis), difference.w()), 2 * std::numbers::pi);
  if (!(std::abs(turn) >= least_turn_rad)) return std::nullopt;
  Pose turned = pose;
  turned.root_rotation = Eigen::AngleAxisd(turn, axis).toRotationMatrix() * pose.root_rotation;
  return turned;
}

std::optional<Pose> untwisted_pelvis(const Actor& actor, const Pose& pose, double least_twist_rad) {
  const Skeleton& skeleton = actor.skeleton;
  const auto twist =
      std::find_if(skeleton.dofs.begin(), skeleton.dofs.end(), [](const Dof& dof) { return dof.name == "chest_y"; });
  if (twist == skeleton.dofs.end()) return std::nullopt;
  const auto k = twist - skeleton.dofs.begin();
  if (!(std::abs(pose.angles_rad[k] - twist->rest_rad) >= least_twist_rad)) return std::nullopt;
  Pose untwisted = pose;
  untwisted.angles_rad[k] = twist->rest_rad;
  const auto chest_of = [&](const Pose& p) {
    return Eigen::Matrix3d(forward_kinematics(skeleton, p).camera_from_bone[twist->bone].linear());
  };
  untwisted.root_rotation = chest_of(pose) * chest_of(untwisted).transpose() * pose.root_rotation;
  return untwisted;
}

Pose leant(const Pose& pose, double lean_rad) {
  Pose leaning = pose;
  leaning.root_rotation = Eigen::AngleAxisd(lean_rad, Eigen::Vector3d::UnitX()).toRotationMatrix() * pose.root_rotation;
  return leaning;
}

std::vector<Pose> with_other_legs(const Skeleton& skeleton, const Pose& pose) {
  const auto bent = [&](Pose start, const LegBones& leg, const Bend& bend) {
    const int hip = skeleton.bone_index(leg.hip), knee = skeleton.bone_index(leg.knee);
    if (hip < 0 || knee < 0) return start;
    for (int k = 0; k < skeleton.n_dofs(); ++k) {
      const Dof& dof = skeleton.dofs[k];
      if (!hangs_on(skeleton, dof.bone, hip)) continue;
      double angle = dof.rest_rad;
      if (dof.bone == hip && dof.name.ends_with("_x")) angle -= bend.hip_rad;
      if (dof.bone == knee && dof.name.ends_with("_x")) angle += bend.knee_rad;
      start.angles_rad[k] = std::clamp(angle, dof.min_rad, dof.max_rad);
    }
    return start;
  };
  const auto both = [&](const Bend& bend) { return bent(bent(pose, kLegBones[0], bend), kLegBones[1], bend); };
  return {both(kStraight), both(kSquat), bent(pose, kLegBones[0], kStep), bent(pose, kLegBones[1], kStep)};
}

bool stands_on_edge(const Actor& actor, const Pose& pose, const Pose& previous, const Eigen::Vector3d& up,
                    double least_tilt_rad) {
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
  const PosedSkeleton before = forward_kinematics(actor.skeleton, previous);
  return std::any_of(std::begin(kLegBones), std::end(kLegBones), [&](const LegBones& leg) {
    const int foot = actor.keypoints[leg.ankle].bone;
    if (foot < 0) return false;
    const Eigen::Vector3d sole_up = posed.camera_from_rest[foot].linear() * Eigen::Vector3d::UnitY();
    const double moved_mm =
        move_across_mm(before.camera_from_bone[foot].translation(), posed.camera_from_bone[foot].translation());
    return moved_mm < LC_POSE_STILL_MM && sole_up.dot(up) < std::cos(least_tilt_rad);
  });
}

std::optional<Pose> with_detected_legs(const Actor& actor, const Camera& camera, const Pose& pose,
                                       const Detections& detections, const PoseOptions& options, double least_px) {
  if (!detections.person) return std::nullopt;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  std::vector<int> strayed;  // hips
  for (const LegBones& leg : kLegBones) {
    const int hip = actor.skeleton.bone_index(leg.hip);
    if (hip < 0 || !(detections.keypoints[leg.ankle].confidence >= kTrustedDetection)) continue;
    if (distance_px(actor, camera, positions, detections, leg.ankle) >= least_px) strayed.push_back(hip);
  }
  if (strayed.empty()) return std::nullopt;
  const std::optional<Pose> found = initialize_pose(actor, camera, detections, options);
  if (!found) return std::nullopt;
  Pose bent = pose;
  for (const int hip : strayed) bent = bent_as(actor.skeleton, *found, hip, bent);
  return bent;
}

void with_detected_arms(const Actor& actor, const Camera& camera, Pose pose, const Detections& detections,
                        const PoseOptions& options, const LeastStray& least,
                        const std::function<Pose(const Pose& bent)>& better_of) {
  if (!detections.person) return;
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  std::vector<int> strayed;  // shoulders
  for (const ArmPoints& arm : kArmPoints) {
    const int shoulder = actor.skeleton.bone_index(arm.shoulder);
    const auto distance = [&](Keypoint k) {
      return detections.keypoints[k].confidence > 0 ? distance_px(actor, camera, positions, detections, k) : 0;
    };
    const auto depth_mm = [&] {  // of an elbow on the other side of the shoulder, from where the network sees it
      const KeypointDetection &upper = detections.keypoints[arm.upper], &elbow = detections.keypoints[arm.elbow];
      if (!(elbow.confidence >= kTrustedDetection) || actor.keypoints[arm.upper].bone < 0) return 0.0;
      const double seen = elbow.z_mm - upper.z_mm, own = (positions[arm.elbow] - positions[arm.upper]).z();
      return seen * own < 0 ? std::abs(seen - own) : 0.0;
    };
    if (shoulder < 0) continue;
    if (std::max(distance(arm.elbow), distance(arm.wrist)) >= least.px || depth_mm() >= least.depth_mm)
      strayed.push_back(shoulder);
  }
  if (strayed.empty()) return;
  const std::optional<Pose> found = initialize_pose(actor, camera, detections, options);
  if (!found) return;
  for (const int shoulder : strayed) pose = better_of(bent_as(actor.skeleton, *found, shoulder, pose));
}

}  // namespace livecap
