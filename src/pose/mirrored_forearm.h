// A forearm that the picture cannot tell from its mirror image in depth: one that points as far from the camera as
// another one points towards it has the same outline. Where that is the likelier one, stage I is solved from there too.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "actor/actor.h"
#include "base/detections.h"

namespace livecap {

struct MirroredForearm {
  Keypoint elbow = kLeftElbow;  // or kRightElbow
  int bone = 0;                 // the forearm's
  Eigen::Matrix3d turn;         // of the forearm, camera frame
  Eigen::Vector3d wrist_mm;     // camera frame: the other place on its ray that is as far from the elbow
};

// nullopt when the forearm would turn by less than least_turn_rad, or the actor has no such arm.
std::optional<MirroredForearm> mirrored_forearm(const Actor& actor, const Pose& pose, Keypoint elbow,
                                                double least_turn_rad);

// `pose` with the wrist as near to mirrored.wrist_mm as the upper arm's twist (searched for, off its limits) and the
// elbow's bend bring it.
Pose with_mirrored_forearm(const Actor& actor, const Pose& pose, const MirroredForearm& mirrored);

}  // namespace livecap
