// What E_rest draws each joint angle to: as a rule the actor's rest. An arm of which the network sees neither elbow nor
// wrist is hidden, mostly by a trunk that turns, and what the outline and the other arm's skin pull it to is chance:
// its angles are drawn to where they were, so that it goes along with the trunk. Of an arm whose wrist alone is hidden
// so are the forearm's.
#pragma once

#include <vector>

#include "actor/actor.h"
#include "base/detections.h"
#include "geometry/skeleton.h"
#include "pose/pose_options.h"

namespace livecap {

struct RestAngle {
  double rad = 0;
  double weight = 0;  // of the squared difference
};

// [n_dofs]. previous: nullptr where the pose follows none; then nothing is held.
std::vector<RestAngle> rest_angles(const Actor& actor, const Detections& detections, const Pose* previous,
                                   const PoseOptions& options);

// How much more E_rest of `pose` is with what is held after `previous` than with nothing held.
double held_energy(const Actor& actor, const Detections& detections, const Pose& previous, const PoseOptions& options,
                   const Pose& pose);

}  // namespace livecap
