// Whole bodies that were matched one stripe or check further round: clothes with a pattern look nearly right there.
#pragma once

#include <optional>

#include "actor/actor.h"
#include "livecap/detections.h"
#include "pose/pose_options.h"

namespace livecap {

// `pose` turned about the trunk's own axis (pelvis to neck) until it faces where the 3D detections face. nullopt when
// that is less than least_turn_rad, or unknown (see torso_rotation), or
// the network is not sure of hips and shoulders.
std::optional<Pose> turned_trunk(const Actor& actor, const Pose& pose, const Detections& detections,
                                 const PoseOptions& options, double least_turn_rad);

}  // namespace livecap
