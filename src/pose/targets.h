// What one frame asks of the skeleton's keypoints: the constants of E_2D, E_3D and E_temporal, confidence and lambda_i
// multiplied in.
#pragma once

#include <Eigen/Core>
#include <array>

#include "actor/actor.h"
#include "base/detections.h"
#include "geometry/skeleton.h"
#include "livecap/camera.h"
#include "pose/pose_options.h"
#include "pose/rebone.h"

namespace livecap {

struct KeypointTarget {
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();           // P_2D
  Eigen::Vector3d detection_mm = Eigen::Vector3d::Zero();          // P_3D, root-centred
  Eigen::Vector3d previous_position_mm = Eigen::Vector3d::Zero();  // of the previous frame, camera frame
  double weight_2d = 0;                                            // factors of the squared residuals; 0 = no such row
  double weight_3d = 0;
  double weight_temporal = 0;
};

// Confidence from which a detection may overrule the picture.
inline constexpr float kTrustedDetection = 0.5f;

using KeypointTargets = std::array<KeypointTarget, kKeypointCount>;

// Camera-frame positions of the actor's keypoints [mm]; zero for one without anchor.
std::array<Eigen::Vector3d, kKeypointCount> keypoint_positions(const Actor& actor, const PosedSkeleton& posed);

// Where a point with z > 0 [mm, camera frame] lies in an undistorted picture [px].
Eigen::Vector2d project_px(const Camera& camera, const Eigen::Vector3d& point_mm);

// P_3D as E_3D takes it: re-boned unless options.rebone is off.
Keypoints3d detected_points(const Actor& actor, const Detections& detections, const PoseOptions& options);

// previous: the last frame's pose, or nullptr (no temporal term). Detections that are not finite count as unknown; so
// do all when detections.person is false. E_temporal has the 19 body keypoints, the others the
// face as well.
KeypointTargets make_targets(const Actor& actor, const Detections& detections, const Pose* previous,
                             const PoseOptions& options);

// t' that minimises E_3D for given keypoint positions: the weighted mean of p - P_3D.
Eigen::Vector3d best_t_prime(const KeypointTargets& targets,
                             const std::array<Eigen::Vector3d, kKeypointCount>& positions);

// Divides each lambda_i of E_3D by 1 + (r / scale_mm)^2, r: how far the keypoint is from its detection (with
// best_t_prime) at these positions. A detection's depth of a limb is off by 60 to 100 mm at times, for many frames on
// end, and squared it would outweigh all that the picture tells.
void doubt_far_detections(KeypointTargets& targets, const std::array<Eigen::Vector3d, kKeypointCount>& positions,
                          double scale_mm);

// r^2 / (1 + r^2 / scale^2), r^2 where scale is 0 (Geman and McClure): by this, the same function for all, poses from
// different starts are compared. It ends at scale^2, so that the picture tells which of two poses is right when both
// are far from a detection; Cauchy's cost, which the weight above minimises, grows without end.
double doubted_cost(double r_squared, double scale);

}  // namespace livecap
