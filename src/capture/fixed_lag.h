// A filter over what was captured, [s, 1 - 2s, s] once or several times over: each frame waits for as many successors.
// What trembles from frame to frame is network noise and matches that come and go; people do not move at half the frame
// rate. Twice with s = 0.3 is [9 24 34 24 9] / 100.
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
  // skeleton: of all poses, outlives this. neighbor_share: s, in [0, 0.5]; passes: at least 1. Throws ConfigError.
  FixedLag(const Skeleton& skeleton, double neighbor_share, int passes);

  // Takes a frame and gives the one that has waited for long enough (with a share of 0 the frame itself): in every pass
  // pose and vertices of a tracked frame are smoothed with those of both its neighbours. They stay as they were where a
  // neighbour was not tracked, belongs to another track, was dropped, is much further away in time than the other,
  // which would move it along, or moved faster than people do.
  std::optional<WorkItem> push(WorkItem item);
  // The next of those that still wait, if any.
  std::optional<WorkItem> flush();

 private:
  class Pass {
   public:
    Pass(const Skeleton& skeleton, double neighbor_share) : skeleton_(&skeleton), neighbor_share_(neighbor_share) {}
    std::optional<WorkItem> push(WorkItem item);
    std::optional<WorkItem> flush();

   private:
    struct Neighbor {
      TrackResult result;
      double pts_ms;
    };
    void smooth(const WorkItem* next);

    const Skeleton* skeleton_;
    double neighbor_share_;
    std::optional<WorkItem> waiting_;
    std::optional<Neighbor> previous_;  // as it came, when it is a neighbour of the waiting one
  };

  std::vector<Pass> passes_;  // none with a share of 0
};

}  // namespace livecap
