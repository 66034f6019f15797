#include "eval/body_points.h"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <string>

namespace livecap {
namespace {

using Eigen::Vector3d;

// The bone or keypoint of that name at rest; bone -1: there is none.
KeypointAnchor rest_point(const Actor& actor, const std::string& name) {
  if (const int bone = actor.skeleton.bone_index(name); bone >= 0) {
    const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
    return {bone, rest.camera_from_bone[bone].translation()};
  }
  const auto keypoint = std::find(std::begin(kKeypointNames), std::end(kKeypointNames), name);
  if (keypoint == std::end(kKeypointNames)) return {};
  return actor.keypoints[keypoint - std::begin(kKeypointNames)];
}

}  // namespace

std::optional<Pose> captured_pose(const CaptureFolder& capture, int64_t row, const std::vector<float>& joints_mm) {
  const Skeleton& skeleton = capture.actor.skeleton;
  if (joints_mm.empty() || row >= static_cast<int64_t>(capture.angles.frames.size())) return std::nullopt;
  const std::vector<double>& angles_deg = capture.angles.frames[row];
  if (angles_deg.empty()) return std::nullopt;
  Pose pose = rest_pose(skeleton);
  pose.root_rotation.setIdentity();
  pose.root_translation_mm.setZero();
  for (int k = 0; k < skeleton.n_dofs(); ++k) {
    const int column = index_of(capture.angles.names, skeleton.dofs[k].name);
    if (column < 0 && skeleton.dofs[k].name.ends_with("ankle_z")) continue;  // not in captures of before feet tilted
    if (column < 0) return std::nullopt;
    pose.angles_rad[k] = angles_deg[column] * std::numbers::pi / 180;
  }
  const PosedSkeleton own = forward_kinematics(skeleton, pose);
  Eigen::Matrix3Xd from(3, skeleton.n_bones()), to(3, skeleton.n_bones());
  for (int bone = 0; bone < skeleton.n_bones(); ++bone) {
    const int joint = index_of(capture.joints.names, skeleton.bones[bone].name);
    if (joint < 0) return std::nullopt;
    from.col(bone) = own.camera_from_bone[bone].translation();
    to.col(bone) = Eigen::Map<const Eigen::Vector3f>(&joints_mm[3 * joint]).cast<double>();
  }
  if (!to.allFinite()) return std::nullopt;
  const Eigen::Isometry3d camera_from_own(Eigen::umeyama(from, to, false));
  pose.root_rotation = camera_from_own.linear();
  pose.root_translation_mm = camera_from_own.translation();
  return pose;
}

std::vector<Eigen::Isometry3d> captured_bones(const CaptureFolder& capture, int64_t row,
                                              const std::vector<float>& joints_mm) {
  const std::optional<Pose> pose = captured_pose(capture, row, joints_mm);
  return pose ? forward_kinematics(capture.actor.skeleton, *pose).camera_from_rest : std::vector<Eigen::Isometry3d>();
}

CarriedJoints::CarriedJoints(const Actor& actor, const Actor& truth, const RestOverlay& overlay,
                             const std::vector<JointPair>& pairs) {
  const Eigen::Isometry3d actor_from_truth = overlay.truth_from_actor.inverse();
  for (const JointPair& pair : pairs) {
    const KeypointAnchor captured = rest_point(actor, pair.name), expected = rest_point(truth, pair.name);
    if (captured.bone < 0 || expected.bone < 0) continue;
    points_.push_back({pair.captured, captured.bone, actor_from_truth * expected.rest_position_mm});
  }
}

std::vector<float> CarriedJoints::at(std::vector<float> joints_mm, const std::vector<Eigen::Isometry3d>& bones) const {
  for (const Point& point : points_)
    Eigen::Vector3f::Map(&joints_mm[3 * point.joint]) = (bones[point.bone] * point.rest_mm).cast<float>();
  return joints_mm;
}

}  // namespace livecap
