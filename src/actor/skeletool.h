// Import of the Skeletool text formats in which the LiveCap and MonoPerfCap data were published: skeletons, skinning
// weights, motions and camera calibrations. Lengths are millimetres, angles radians, as everywhere here.
//
//   .skeleton     "Skeletool Skeleton Definition V1.0"; then the sections
//                 joints: N          name type(revolute|prismatic) parent ox oy oz ax ay az scale
//                 markers: N         name joint point ox oy oz [size [r g b]]
//                 scaling joints: N  name M, then M lines with a joint name
//                 dofs: N            name M; "limits min max" or "nolimits"; then M lines joint weight
//   .skin         "Skeletool character skinning file V1.0"; bones: one line of names; vertex weights:
//                 index (bone weight)*. Binds the mesh at zero angles, all scales 1
//   .motion       "Skeletool Motion File V1.0"; per line: frame, one value per degree of freedom
//   .calibration  "Skeletool Camera Calibration File V1.0"; per camera: name, sensor, size, animated, intrinsic,
//                 extrinsic (row-major 4x4), radial
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "geometry/skeleton.h"
#include "livecap/camera.h"

namespace livecap {

struct SkeletoolMarker {
  std::string name;
  int bone = 0;
  Eigen::Vector3d rest_position_mm = Eigen::Vector3d::Zero();
};

// One Skeletool parameter may turn several joints (a spine), each with a weight.
struct SkeletoolSkeleton {
  Skeleton skeleton;                         // one Dof per revolute joint below the root; bound at zero angles
  std::vector<std::string> parameter_names;  // [n_parameters] the file's degrees of freedom
  Eigen::MatrixXd angles_from_parameters;    // [n_dofs x n_parameters]
  std::vector<SkeletoolMarker> markers;
  std::vector<std::string> notes;

  // The joints that carry the root: their own single-axis chain, evaluated into Pose's root.
  struct RootJoint {
    bool revolute = false;
    Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  };
  std::vector<RootJoint> root_joints;
  Eigen::MatrixXd root_from_parameters;  // [n_root_joints x n_parameters]

  std::vector<std::string> joint_names;  // every joint of the file, in its order
  std::vector<int> bone_of_joint;        // bone that moves with it
  std::string scaled_joint;              // the first whose scale is not 1; empty: none

  int n_parameters() const { return static_cast<int>(parameter_names.size()); }
  // Pose in the file's world frame. Throws LogicError for a wrong number of parameters.
  Pose pose(const Eigen::VectorXd& parameters) const;
};

// All throw IoError naming file, line and what was expected.
SkeletoolSkeleton load_skeletool_skeleton(const std::filesystem::path& path);

// Weights by bone of `skeleton`, four strongest, normalised. A bone name of the file means the last joint whose name
// begins with it. What the weaker ones had is appended to notes.
SkinWeights load_skeletool_skin(const std::filesystem::path& path, const SkeletoolSkeleton& skeleton,
                                std::vector<std::string>& notes);

struct SkeletoolMotion {
  std::vector<int> frames;                  // frame numbers of the file, ascending
  std::vector<Eigen::VectorXd> parameters;  // one per frame
};
SkeletoolMotion load_skeletool_motion(const std::filesystem::path& path, int n_parameters);

struct SkeletoolCamera {
  std::string name;
  Camera camera;
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();  // mm
};
// At least one; static cameras without radial distortion.
std::vector<SkeletoolCamera> load_skeletool_cameras(const std::filesystem::path& path);

}  // namespace livecap
