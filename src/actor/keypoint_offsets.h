// Networks place "shoulder" or "hand" differently from a rig's joints. A table of offsets per network moves the actor's
// keypoint anchors to the points the network means.
#pragma once

#include "actor/actor.h"

namespace livecap {

// Moves the anchors of `actor` to what MediaPipe Pose calls by these names. The offsets are anatomical definitions
// (acromion instead of joint centre, mouth instead of chin, midpoint of the shoulders instead of the neck's base ...),
// measured on three sequences with ground truth and scaled with the actor's height (docs/experiments.md).
void use_mediapipe_anchors(Actor& actor);

}  // namespace livecap
