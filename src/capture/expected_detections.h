// What a perfect network would see of a pose.
#pragma once

#include "actor/actor.h"
#include "base/detections.h"
#include "livecap/camera.h"

namespace livecap {

// All keypoints that the actor has, with the given confidence. Joints must be in front of the camera.
Detections expected_detections(const Actor& actor, const Camera& camera, const Pose& pose, float confidence);

}  // namespace livecap
