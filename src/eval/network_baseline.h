// What the pose network alone says, as a baseline: its 3D keypoints, brought to the actor's bone lengths and placed in
// front of the camera by its 2D keypoints. No skeleton, no limits, no time, no silhouette.
#pragma once

#include <string>
#include <vector>

#include "actor/actor.h"
#include "base/detections.h"
#include "livecap/camera.h"

namespace livecap {

// Names of the points of network_joints in its order: the keypoints', with the capture's "root" for the pelvis.
std::vector<std::string> network_joint_names();

// [3*kKeypointCount] mm, camera frame, NaN for what the network does not know; empty when nobody was detected or the 2D
// points do not determine a place. actor: with the anchors of the network. camera: without distortion.
std::vector<float> network_joints(const Actor& actor, const Camera& camera, const Detections& detections);

}  // namespace livecap
