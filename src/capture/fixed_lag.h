// A filter of three frames over what was captured, [s, 1 - 2s, s]: each frame waits for its successor. What trembles
// from frame to frame is network noise and matches that come and go; people do not move at half the frame rate.
#pragma once

#include <optional>
#include <vector>

#include "capture/work_item.h"
#include "geometry/skeleton.h"

namespace livecap {

// Joint angles and root translation: s previous + (1 - 2s) current + s next; the root's rotation by rotation vectors
// from the current one.
Pose smooth_pose(const Pose& previous, const Pose& current, const Pose& next, double neighbor_share);

class FixedLag {
 public:
  // neighbor_share: s, in [0, 0.5]. Throws ConfigError.
  explicit FixedLag(double neighbor_share);

  // Takes a frame and gives the one before it (with a share of 0 the frame itself): pose and vertices of a tracked
  // frame smoothed with those of both its neighbours. It stays as captured where a neighbour was not tracked, belongs
  // to another track, was dropped, or is much further away in time than the other: the filter would move it along.
  std::optional<WorkItem> push(WorkItem item);
  // The last one.
  std::optional<WorkItem> flush();

 private:
  struct Neighbor {
    TrackResult result;
    double pts_ms;
  };
  void smooth(const WorkItem* next);

  double neighbor_share_;
  std::optional<WorkItem> waiting_;
  std::optional<Neighbor> previous_;  // as captured, when it is a neighbour of the waiting one
};

}  // namespace livecap
