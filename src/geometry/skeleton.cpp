#include "geometry/skeleton.h"

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

int Skeleton::bone_index(const std::string& name) const {
  for (int i = 0; i < n_bones(); ++i) {
    if (bones[i].name == name) return i;
  }
  return -1;
}

void Skeleton::validate() const {
  if (bones.empty()) throw LogicError("skeleton: no bones");
  if (n_dofs() > kMaxDofs) throw LogicError(format("skeleton: %d joint angles, at most %d", n_dofs(), kMaxDofs));
  for (int b = 0; b < n_bones(); ++b) {
    if (b == 0 ? bones[b].parent != -1 : bones[b].parent < 0 || bones[b].parent >= b)
      throw LogicError(format("skeleton: bone %d \"%s\" has parent %d", b, bones[b].name.c_str(), bones[b].parent));
  }
  for (const Dof& dof : dofs) {
    if (dof.bone < 0 || dof.bone >= n_bones() || std::abs(dof.axis.norm() - 1) > 1e-6 || !(dof.min_rad <= dof.max_rad))
      throw LogicError("skeleton: joint angle \"" + dof.name + "\" has a wrong bone, axis or limits");
  }
}

Pose rest_pose(const Skeleton& skeleton) {
  Pose pose;
  pose.root_translation_mm = skeleton.root_rest_mm;
  pose.angles_rad.resize(skeleton.n_dofs());
  for (int k = 0; k < skeleton.n_dofs(); ++k) pose.angles_rad[k] = skeleton.dofs[k].rest_rad;
  return pose;
}

namespace {

// camera_from_bone and the joint axes of one pose.
void walk_chain(const Skeleton& skeleton, const Pose& pose, PosedSkeleton& out) {
  out.camera_from_bone.resize(skeleton.n_bones());
  out.dof_axis.resize(skeleton.n_dofs());
  out.dof_origin_mm.resize(skeleton.n_dofs());
  for (int b = 0; b < skeleton.n_bones(); ++b) {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    if (b == 0) {
      frame.linear() = pose.root_rotation;
      frame.translation() = pose.root_translation_mm;
    } else {
      frame = out.camera_from_bone[skeleton.bones[b].parent];
      frame.translate(skeleton.bones[b].offset_mm);
    }
    for (int k = 0; k < skeleton.n_dofs(); ++k) {
      if (skeleton.dofs[k].bone != b) continue;
      out.dof_axis[k] = frame.linear() * skeleton.dofs[k].axis;
      out.dof_origin_mm[k] = frame.translation();
      if (pose.angles_rad[k] == 0) continue;  // all of a T-pose's
      frame.rotate(Eigen::AngleAxisd(pose.angles_rad[k], skeleton.dofs[k].axis));
    }
    out.camera_from_bone[b] = frame;
  }
}

}  // namespace

PosedSkeleton forward_kinematics(const Skeleton& skeleton, const Pose& pose) {
  if (pose.angles_rad.size() != skeleton.n_dofs())
    throw LogicError(format("forward_kinematics: %d angles for %d joints", static_cast<int>(pose.angles_rad.size()),
                            skeleton.n_dofs()));
  PosedSkeleton rest;
  walk_chain(skeleton, rest_pose(skeleton), rest);
  PosedSkeleton posed;
  walk_chain(skeleton, pose, posed);
  posed.camera_from_rest.resize(skeleton.n_bones());
  for (int b = 0; b < skeleton.n_bones(); ++b)
    posed.camera_from_rest[b] = posed.camera_from_bone[b] * rest.camera_from_bone[b].inverse();
  return posed;
}

bool hangs_on(const Skeleton& skeleton, int bone, int on) {
  while (bone >= 0 && bone != on) bone = skeleton.bones[bone].parent;
  return bone >= 0;
}

std::vector<uint64_t> dofs_moving_bones(const Skeleton& skeleton) {
  std::vector<uint64_t> masks(skeleton.n_bones(), 0);
  for (int b = 0; b < skeleton.n_bones(); ++b) {
    if (b > 0) masks[b] = masks[skeleton.bones[b].parent];
    for (int k = 0; k < skeleton.n_dofs(); ++k) {
      if (skeleton.dofs[k].bone == b) masks[b] |= uint64_t{1} << k;
    }
  }
  return masks;
}

std::vector<float> bone_dual_quats(const PosedSkeleton& posed) {
  std::vector<float> result;
  result.reserve(8 * posed.camera_from_rest.size());
  for (const Eigen::Isometry3d& motion : posed.camera_from_rest) {
    const Eigen::Quaterniond real = Eigen::Quaterniond(motion.linear()).normalized();
    const Eigen::Vector3d t = motion.translation();
    const Eigen::Quaterniond dual = Eigen::Quaterniond(0, 0.5 * t.x(), 0.5 * t.y(), 0.5 * t.z()) * real;
    for (double value : {real.w(), real.x(), real.y(), real.z(), dual.w(), dual.x(), dual.y(), dual.z()})
      result.push_back(static_cast<float>(value));
  }
  return result;
}

Pose add_increment(const Pose& pose, const Eigen::VectorXd& delta) {
  if (delta.size() != 6 + pose.angles_rad.size())
    throw LogicError(format("add_increment: %d values for %d unknowns", static_cast<int>(delta.size()),
                            static_cast<int>(6 + pose.angles_rad.size())));
  Pose result = pose;
  result.root_rotation = rotation_from_vector(delta.head<3>()) * pose.root_rotation;
  result.root_rotation = Eigen::Quaterniond(result.root_rotation).normalized().toRotationMatrix();
  result.root_translation_mm += delta.segment<3>(3);
  result.angles_rad += delta.tail(pose.angles_rad.size());
  return result;
}

Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector_rad / angle).toRotationMatrix();
}

Eigen::Vector3d vector_from_rotation(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd angle_axis(rotation);
  return angle_axis.angle() * angle_axis.axis();
}

}  // namespace livecap
