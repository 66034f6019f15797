#include "pose/strayed_legs.h"

#include <algorithm>
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
constexpr float kTrusted = 0.5f;  // confidence of a detection that may overrule the picture

// Whether the bone is one of these or hangs on one.
bool hangs_on(const Skeleton& skeleton, int bone, const std::vector<int>& these) {
  for (; bone >= 0; bone = skeleton.bones[bone].parent) {
    if (std::find(these.begin(), these.end(), bone) != these.end()) return true;
  }
  return false;
}

}  // namespace

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

}  // namespace livecap
