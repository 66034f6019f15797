// Poses to start from as well where texture and silhouette may have led astray, as the detections have them: whole
// bodies that were matched one stripe or check further round, where clothes with a pattern look nearly right, and legs
// that hold on to the other one's shoe, which the robust E_2D lets them. Arms that a turn hid. A mirrored forearm:
// pose/mirrored_forearm.h. A pelvis that the skirt alone led astray, turned back. And legs that bend, where the picture
// hardly tells bent ones that stand below the body from straight ones behind it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

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

// `pose` with both legs straight, with both bent as in a squat, and with one bent as in a step, the left one first.
// What else is turned in these legs, feet too, is at rest.
std::vector<Pose> with_other_legs(const Skeleton& skeleton, const Pose& pose);

// Whether a foot that hardly moves across the line of sight is tilted by more than least_tilt_rad against `up` (unit),
// as none is that stands for long: on its toes before the body, or on its heel behind it, it looks like a flat one.
bool stands_on_edge(const Actor& actor, const Pose& pose, const Pose& previous, const Eigen::Vector3d& up,
                    double least_tilt_rad);

// `pose` with every leg whose ankle lies at least least_px from its detection bent as initialize_pose would bend it.
// nullopt when there is none or the detections do not tell.
std::optional<Pose> with_detected_legs(const Actor& actor, const Camera& camera, const Pose& pose,
                                       const Detections& detections, const PoseOptions& options, double least_px);

struct LeastStray {
  double px;        // in the picture
  double depth_mm;  // along the camera's axis
};

// Asks better_of for the better one of `pose` and of `pose` with one arm bent as initialize_pose would bend it, for
// each whose elbow or wrist lies that far from its detection, or whose elbow points that far away from the camera where
// the network sees it point towards it, or the other way round: both have the same outline. The second arm is bent in
// what is better then.
void with_detected_arms(const Actor& actor, const Camera& camera, Pose pose, const Detections& detections,
                        const PoseOptions& options, const LeastStray& least,
                        const std::function<Pose(const Pose& bent)>& better_of);

}  // namespace livecap
