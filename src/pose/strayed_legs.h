// Legs that hold on to something else: a foot on the other one's shoe fits the silhouette and the texture as well, and
// the robust E_2D lets it. (The same for arms made two of five sequences worse: the network's elbows are bent too far.)
#pragma once

#include <optional>

#include "actor/actor.h"
#include "livecap/camera.h"
#include "livecap/detections.h"
#include "pose/pose_options.h"

namespace livecap {

// `pose` with every leg whose ankle lies at least least_px from its detection bent as initialize_pose would bend it.
// nullopt when there is none or the detections do not tell.
std::optional<Pose> with_detected_legs(const Actor& actor, const Camera& camera, const Pose& pose,
                                       const Detections& detections, const PoseOptions& options, double least_px);

}  // namespace livecap
