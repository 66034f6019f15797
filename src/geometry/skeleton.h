// The kinematic chain: rigid bones joined by single-axis joints (LiveCap-32, or whatever a Skeletool file holds).
//
// Rest frame: mm, +X the subject's left, +Y up, +Z the subject's front. At zero angles (T-pose) every bone frame is
// parallel to the rest frame. The template mesh is bound at `rest_rad`, which is not zero for an A-pose template.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

namespace livecap {

struct Bone {
  std::string name;
  int parent = -1;                                      // -1 for bone 0, the root (pelvis)
  Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();  // its origin in the parent's frame
};

// One joint angle. Angles of one bone are applied in listed order, the first closest to the parent.
struct Dof {
  std::string name;                                 // "left_shoulder_z"
  int bone = 0;                                     // the bone it turns
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // unit, in the bone's frame
  double min_rad = 0;
  double max_rad = 0;
  double rest_rad = 0;    // angle in which the template is bound
  double rest_share = 0;  // at least 0: how strongly stage I draws it there (E_rest), 1 as a chest
};

struct Skeleton {
  std::vector<Bone> bones;                                 // parents before children; bone 0 is the root
  std::vector<Dof> dofs;                                   // grouped by bone, at most kMaxDofs
  Eigen::Vector3d root_rest_mm = Eigen::Vector3d::Zero();  // origin of bone 0 in the template's rest frame

  int n_bones() const { return static_cast<int>(bones.size()); }
  int n_dofs() const { return static_cast<int>(dofs.size()); }
  int bone_index(const std::string& name) const;  // -1 when there is none
  // Throws LogicError when parents do not precede children, an axis is not unit or a limit pair is reversed.
  void validate() const;
};

inline constexpr int kMaxDofs = 64;

// S = {theta, R, t}: where the skeleton is. The root's rotation and translation map bone 0's frame to the camera.
struct Pose {
  Eigen::Matrix3d root_rotation = Eigen::Matrix3d::Identity();    // camera_from_root
  Eigen::Vector3d root_translation_mm = Eigen::Vector3d::Zero();  // origin of bone 0 in the camera frame
  Eigen::VectorXd angles_rad;                                     // [n_dofs]
};

// The pose in which the template is bound, in the rest frame.
Pose rest_pose(const Skeleton& skeleton);

// Everything forward kinematics knows about one pose.
struct PosedSkeleton {
  std::vector<Eigen::Isometry3d> camera_from_bone;  // [n_bones]
  std::vector<Eigen::Isometry3d> camera_from_rest;  // [n_bones] moves a template point bound to the bone
  std::vector<Eigen::Vector3d> dof_axis;            // [n_dofs] unit, camera frame
  std::vector<Eigen::Vector3d> dof_origin_mm;       // [n_dofs] a point on the axis, camera frame
};

PosedSkeleton forward_kinematics(const Skeleton& skeleton, const Pose& pose);

// Whether `bone` is `on` or lies below it.
bool hangs_on(const Skeleton& skeleton, int bone, int on);

// Bit k of entry b is set when joint angle k moves bone b. [n_bones]
std::vector<uint64_t> dofs_moving_bones(const Skeleton& skeleton);

// camera_from_rest as unit dual quaternions, [8*n_bones]: real w,x,y,z, dual w,x,y,z (kernels/shared/dual_quat.h).
std::vector<float> bone_dual_quats(const PosedSkeleton& posed);

// Adds the increment delta = [rotation vector (camera axes) | translation mm | angles rad], size 6 + n_dofs.
// The rotation is updated on the left by its exponential map, about the root's origin.
Pose add_increment(const Pose& pose, const Eigen::VectorXd& delta);

// Rotation matrix of a rotation vector, and back (angle in [0, pi]).
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d& vector_rad);
Eigen::Vector3d vector_from_rotation(const Eigen::Matrix3d& rotation);

}  // namespace livecap
