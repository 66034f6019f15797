// Where the Gauss-Newton solver starts: a prediction from the last two frames, or, for a first frame and after a loss,
// a pose found from one frame's detections alone (paper, "Skeletal Pose Estimation": "extrapolating the poses of the
// last two frames in joint angle space based on an explicit Euler step"; "no careful initialization").
#pragma once

#include <array>
#include <optional>

#include "actor/actor.h"
#include "base/detections.h"
#include "livecap/camera.h"
#include "pose/pose_options.h"

namespace livecap {

// The Euler step of `previous` from `before_previous` (nullptr: no motion known, `previous` itself), shortened to the
// option's bounds and kept inside the joint limits where `previous` was.
Pose predict_pose(const Skeleton& skeleton, const Pose* before_previous, const Pose& previous,
                  const PoseOptions& options);

// How the root is turned when the torso (pelvis, hips, neck, shoulders) lies on the 3D detections as well as it can.
// nullopt when nobody was detected or fewer than three of these points are known.
std::optional<Eigen::Matrix3d> torso_rotation(const Actor& actor, const Detections& detections,
                                              const PoseOptions& options);

// The same of a pose's own keypoints: the root's rotation where chest and collarbones are at rest.
std::optional<Eigen::Matrix3d> torso_rotation(const Actor& actor,
                                              const std::array<Eigen::Vector3d, kKeypointCount>& positions);

// Root rotation by rigid alignment of the torso to the 3D detections, joint angles by cyclic coordinate descent on the
// re-boned 3D keypoints, root translation by linear least squares on the 2D detections.
// nullopt as for torso_rotation.
std::optional<Pose> initialize_pose(const Actor& actor, const Camera& camera, const Detections& detections,
                                    const PoseOptions& options);

}  // namespace livecap
