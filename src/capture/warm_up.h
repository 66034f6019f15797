// Every program built and every kernel launched once before the first frame, so that no frame waits for a compiler:
// those of the network and of the tracker. Those of the segmentation: Segmenter::warm_up().
#pragma once

#include "capture/tracker.h"
#include "detect/pose_detector.h"

namespace livecap {

// Runs one empty picture through the network, then forgets it.
void warm_up_detector(detect::PoseDetector& detector, const Camera& camera);

// Tracks the resting actor, as seen 4 m in front of the camera, for three frames, then forgets it.
void warm_up_tracker(Tracker& tracker, const Actor& actor, const Camera& camera);

}  // namespace livecap
