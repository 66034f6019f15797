// Points of the person's clothes followed from picture to picture of a turn: what fixes the turn finer than a network's
// keypoints, which are biased differently from every side.
#pragma once

#include <vector>

#include "views/turn_bundle.h"
#include "views/view.h"

namespace livecap {

struct TurnTracksOptions {
  int per_view = 150;      // new points a picture
  int longest = 9;         // pictures
  double return_px = 0.7;  // a point tracked there and back must come back so near
  double sigma_px = 0.6;
};

// views: in the order of the turn, with masks; the last is followed by the first when `closed`. Points are numbered
// from first_point on; each is seen in three views at least, and stays inside the masks.
std::vector<TurnObservation> track_turn(const std::vector<View>& views, bool closed, int first_point,
                                        const TurnTracksOptions& options = {});

}  // namespace livecap
