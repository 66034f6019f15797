// The proportions of a person from keypoints and silhouettes of several frames: one Gauss-Newton problem over the
// proportions and all poses, the poses eliminated frame by frame.
#pragma once

#include <vector>

#include "fit/frame_poser.h"
#include "fit/proportions.h"

namespace livecap {

// actor: that of `poser`, whose keypoints are the network's. Frames that are not posed do not count; the others' poses
// become those of the actor with the new proportions (at the actor's scale).
Proportions fit_proportions(FramePoser& poser, const Actor& actor, const Camera& camera, std::vector<FitFrame>& frames);

}  // namespace livecap
