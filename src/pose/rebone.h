// P_3D in the actor's size (paper, "Sparse 2D and 3D Alignment Constraint": "we rescale the regressed skeleton
// according to the bone lengths of our parameterized skeleton model"): of a network's 3D keypoints only the bone
// directions are kept; lengths are the template's, from the mid-hip outward.
#pragma once

#include <Eigen/Core>
#include <array>

#include "actor/actor.h"
#include "base/detections.h"

namespace livecap {

struct Keypoint3d {
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();  // camera axes, relative to the pelvis keypoint
  double confidence = 0;                                  // least along the path from the pelvis; 0 = unknown
};

using Keypoints3d = std::array<Keypoint3d, kKeypointCount>;

// The keypoint whose bone leads to `keypoint`; -1 for the pelvis.
int keypoint_parent(int keypoint);

// A keypoint without anchor is unknown, and its children hang on its nearest ancestor that has one. When
// the detections lack the pelvis, the others are placed from the origin, which is where it is by definition.
Keypoints3d rebone(const Actor& actor, const Detections& detections);

// The detections as they are, for detections already in the actor's size.
Keypoints3d keypoints_3d(const Actor& actor, const Detections& detections);

}  // namespace livecap
