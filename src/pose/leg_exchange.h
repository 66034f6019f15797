// Legs that a network exchanged: where they cross in the picture it gives the left foot to the right leg for some
// frames, while the hips stay right.
#pragma once

#include <array>
#include <vector>

#include "actor/actor.h"
#include "base/detections.h"
#include "geometry/skeleton.h"
#include "livecap/camera.h"

namespace livecap {

using KeypointDetections = std::array<KeypointDetection, kKeypointCount>;

// With left and right exchanged from the knees or from the ankles downward.
KeypointDetections with_legs_exchanged(const KeypointDetections& detected, bool from_knees);

// The detections with left and right exchanged from the knees or from the ankles downward, each where that continues
// the predicted pose in the picture better than the detections as they are; usually neither does. Seen from the side
// the legs cover each other and prediction cannot tell them apart: none then.
std::vector<KeypointDetections> exchanged_legs(const Actor& actor, const Camera& camera, const Pose& predicted,
                                               const KeypointDetections& detected);

}  // namespace livecap
