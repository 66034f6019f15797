// A filter over what was captured that waits for a few later frames: what leaves it is a weighted mean of a frame and
// its neighbours. The weights are those of capture/lag_weights.h.
#pragma once

#include <deque>
#include <optional>

#include "capture/lag_weights.h"
#include "capture/work_item.h"
#include "geometry/skeleton.h"

namespace livecap {

// The mean of the poses of a run: joint angles and root translations themselves, the root's rotations as the way from
// that of frame `at` by those in between, in rotation vectors. weights: [run.size()], sum 1.
Pose weighted_pose(const LagRun& run, size_t at, const Eigen::VectorXd& weights);

class FixedLag {
 public:
  // skeleton: of all poses, outlives this. lag: later frames that each waits for, fewer
  // than kMostOfRun; none passes everything as it is. Throws ConfigError.
  FixedLag(const Skeleton& skeleton, int lag, LagWeights weights);

  // Takes a frame and gives the one that has waited for long enough. Pose and vertices of tracked frames are means over
  // their run, as these came: frames without one that was not tracked, belongs to another track or was dropped in
  // between, nor a step in which something moves faster than people do.
  std::optional<WorkItem> push(WorkItem item);
  // The next of those that still wait, if any.
  std::optional<WorkItem> flush();

 private:
  bool goes_on(const WorkItem& item, const LagFrame& frame) const;
  void end_run();
  void smooth(WorkItem& item, size_t at) const;  // at: where in the run
  std::optional<WorkItem> take_first();

  const Skeleton* skeleton_;
  size_t lag_;
  LagWeights weights_;
  std::deque<WorkItem> waiting_;
  LagRun run_;         // as they came, the latest last
  size_t n_open_ = 0;  // the last of those waiting belong to the run and are as they came
};

}  // namespace livecap
