// Where the camera stood around a person who turned before it: from the network's keypoints and points of the clothes
// (docs/actor_build.md).
#pragma once

#include <string>
#include <vector>

#include "base/detections.h"
#include "views/turn_bundle.h"
#include "views/view.h"

namespace livecap {

struct TurnFit {
  Turn turn;
  int n_tracks = 0;     // points of the clothes
  double track_px = 0;  // median distance from their tracks
  double sway_mm = 0;   // rms of how far the body was beside the axis
};

// From keypoints alone; exchanges left and right where the network took the back for the front. Throws ConfigError when
// the person does not hold still.
Turn fit_keypoint_turn(const Camera& camera, std::vector<Detections>& detections, const std::vector<double>& angle_rad);

// views: one turn in its order, one camera, with masks; detections of each, whose left and right are exchanged where
// the network took the back for the front; angle_rad: roughly how far the person had turned. Sets camera_from_world: Y
// up the axis, in roughly mm (one camera does not tell the scale). Throws ConfigError when the person does not hold
// still.
TurnFit fit_turn(std::vector<View>& views, std::vector<Detections>& detections, const std::vector<double>& angle_rad,
                 std::vector<std::string>& notes);

// Left and right exchanged.
void exchange_sides(Detections& detections);

}  // namespace livecap
