#include "pose/posed_step.h"

#include <algorithm>

namespace livecap {

void write_step(const PoseLayout& layout, const PosePoints& points, const PoseState& state, std::span<float> out) {
  // Everything relative to the root's origin; see kernels/pose/layout.h.
  Pose at_root = state.pose;
  at_root.root_translation_mm.setZero();
  const PosedSkeleton posed = forward_kinematics(points.skeleton, at_root);
  const int columns = layout.n_columns;
  std::fill_n(out.begin(), 6 * columns, 0.0f);
  for (int i = 0; i < 3; ++i) {
    out[i * columns + i] = 1.0f;            // root rotation: axis e_i through the root's origin
    out[(3 + i) * columns + 3 + i] = 1.0f;  // root translation: a pure moment
  }
  for (int k = 0; k < layout.n_dofs; ++k) {
    const Eigen::Vector3d moment = posed.dof_origin_mm[k].cross(posed.dof_axis[k]);
    for (int i = 0; i < 3; ++i) {
      out[i * columns + 6 + k] = float(posed.dof_axis[k][i]);
      out[(3 + i) * columns + 6 + k] = float(moment[i]);
    }
  }
  for (int k = 0; k < kKeypointCount; ++k) {
    const KeypointAnchor& anchor = points.keypoints[k];
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    if (anchor.bone >= 0) p = posed.camera_from_rest[anchor.bone] * anchor.rest_position_mm;
    for (int i = 0; i < 3; ++i) out[LC_POSE_STEP_KEYPOINTS(layout) + 3 * k + i] = float(p[i]);
  }
  for (int i = 0; i < 3; ++i) {
    out[LC_POSE_STEP_T_PRIME(layout) + i] = float(state.t_prime_mm[i]);
    out[LC_POSE_STEP_ROOT(layout) + i] = float(state.pose.root_translation_mm[i]);
  }
  for (int k = 0; k < layout.n_dofs; ++k) out[LC_POSE_STEP_ANGLES(layout) + k] = float(state.pose.angles_rad[k]);
  const std::vector<float> dual_quats = bone_dual_quats(posed);
  std::copy(dual_quats.begin(), dual_quats.end(), out.begin() + LC_POSE_STEP_DUAL_QUATS(layout));
  for (size_t k = 0; k < points.soles.size(); ++k) {
    const Eigen::Vector3d p = posed.camera_from_rest[points.soles[k].bone] * points.soles[k].rest_mm;
    for (int i = 0; i < 3; ++i) out[LC_POSE_STEP_SOLES(layout) + 3 * k + i] = float(p[i]);
  }
}

std::vector<double> chain_constants(const PoseLayout& layout, const PosePoints& points) {
  const Skeleton& skeleton = points.skeleton;
  const PosedSkeleton rest = forward_kinematics(skeleton, rest_pose(skeleton));
  std::vector<double> values;
  values.reserve(LC_POSE_CHAIN_SIZE(layout));
  const auto add = [&](const auto& vector) {
    for (const double value : vector) values.push_back(value);
  };
  for (int b = 0; b < skeleton.n_bones(); ++b) {
    const Eigen::Isometry3d bone_from_rest = rest.camera_from_bone[b].inverse();
    add(b == 0 ? Eigen::Vector3d(0, 0, 0) : skeleton.bones[b].offset_mm);
    add(Eigen::Quaterniond(bone_from_rest.linear()).normalized().coeffs());
    add(Eigen::Vector3d(bone_from_rest.translation()));
  }
  for (const Dof& dof : skeleton.dofs) add(dof.axis);
  const auto add_point = [&](int bone, const Eigen::Vector3d& rest_mm) {
    add(Eigen::Vector3d(rest.camera_from_bone[std::max(bone, 0)].inverse() * rest_mm));
  };
  for (const KeypointAnchor& anchor : points.keypoints) add_point(anchor.bone, anchor.rest_position_mm);
  for (const SolePoint& sole : points.soles) add_point(sole.bone, sole.rest_mm);
  return values;
}

std::vector<int32_t> chain_links(const PosePoints& points) {
  std::vector<int32_t> links;
  for (const Bone& bone : points.skeleton.bones) links.push_back(bone.parent);
  for (const Dof& dof : points.skeleton.dofs) links.push_back(dof.bone);
  for (const KeypointAnchor& anchor : points.keypoints) links.push_back(anchor.bone);
  for (const SolePoint& sole : points.soles) links.push_back(sole.bone);
  const std::vector<Dof>& dofs = points.skeleton.dofs;
  const auto joint_from = [&dofs](int bone, size_t k) {
    while (k < dofs.size() && dofs[k].bone != bone) ++k;
    return int32_t(k);
  };
  for (int bone = 0; bone < points.skeleton.n_bones(); ++bone) links.push_back(joint_from(bone, 0));
  for (size_t k = 0; k < dofs.size(); ++k) links.push_back(joint_from(dofs[k].bone, k + 1));
  return links;
}

std::vector<double> state_values(const PoseState& state) {
  const Eigen::Vector4d rotation = Eigen::Quaterniond(state.pose.root_rotation).normalized().coeffs();
  std::vector<double> values(rotation.begin(), rotation.end());
  values.insert(values.end(), state.pose.root_translation_mm.begin(), state.pose.root_translation_mm.end());
  values.insert(values.end(), state.pose.angles_rad.begin(), state.pose.angles_rad.end());
  values.insert(values.end(), state.t_prime_mm.begin(), state.t_prime_mm.end());
  return values;
}

PoseState state_of(std::span<const double> values) {
  PoseState state;
  state.pose.root_rotation = Eigen::Quaterniond(values.data()).toRotationMatrix();
  state.pose.root_translation_mm = Eigen::Map<const Eigen::Vector3d>(values.data() + LC_POSE_STATE_ROOT);
  state.pose.angles_rad =
      Eigen::Map<const Eigen::VectorXd>(values.data() + LC_POSE_STATE_ANGLES, Eigen::Index(values.size()) - 10);
  state.t_prime_mm = Eigen::Map<const Eigen::Vector3d>(values.data() + values.size() - 3);
  return state;
}

}  // namespace livecap
