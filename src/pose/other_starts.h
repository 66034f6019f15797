// Poses to start from as well where texture and silhouette may have led astray, as the detections have them: whole
// bodies that were matched one stripe or check further round, where clothes with a pattern look nearly right, and legs
// that hold on to the other one's shoe, which the robust E_2D lets them. Arms that a turn hid. A mirrored forearm:
// pose/mirrored_forearm.h. And a pelvis that the skirt alone led astray, turned back.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "actor/actor.h"
#include "base/detections.h"
#include "livecap/camera.h"
#include "pose/pose_options.h"

namespace livecap {

// `pose` turned about the trunk's own axis (pelvis to neck) until it faces where the 3D detections face. nullopt when
// that is less than least_turn_rad, or unknown (see torso_rotation), or
// the network is not sure of hips and shoulders.
std::optional<Pose> turned_trunk(const Actor& actor, const Pose& pose, const Detections& detections,
                                 const PoseOptions& options, double least_turn_rad);

// `pose` with the pelvis turned under the chest, which faces where it did, until the spine is not twisted. nullopt when
// it is twisted by less than least_twist_rad, or the chest does not turn about y.
std::optional<Pose> untwisted_pelvis(const Actor& actor, const Pose& pose, double least_twist_rad);

// `pose` leant towards the camera by lean_rad (away from it where that is negative): turned about the root, and the
// camera's x axis.
Pose leant(const Pose& pose, double lean_rad);

// `pose` with every leg whose ankle lies at least least_px from its detection bent as initialize_pose would bend it.
// nullopt when there is none or the detections do not tell.
std::optional<Pose> with_detected_legs(const Actor& actor, const Camera& camera, const Pose& pose,
                                       const Detections& detections, const PoseOptions& options, double least_px);

// Asks better_of for the better one of `pose` and of `pose` with one arm bent as initialize_pose would bend it, for
// each whose elbow or wrist lies at least least_px from its detection. The second arm is bent in what is better then.
void with_detected_arms(const Actor& actor, const Camera& camera, Pose pose, const Detections& detections,
                        const PoseOptions& options, double least_px,
                        const std::function<Pose(const Pose& bent)>& better_of);

}  // namespace livecap
