#include "capture/fixed_lag.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kEvenSteps = 1.5;  // one time step by the other

}  // namespace

Pose smooth_pose(const Pose& previous, const Pose& current, const Pose& next, double neighbor_share) {
  Pose smoothed = current;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (const Pose* neighbor : {&previous, &next}) {
    smoothed.root_translation_mm += neighbor_share * (neighbor->root_translation_mm - current.root_translation_mm);
    smoothed.angles_rad += neighbor_share * (neighbor->angles_rad - current.angles_rad);
    turn += neighbor_share * vector_from_rotation(neighbor->root_rotation * current.root_rotation.transpose());
  }
  smoothed.root_rotation = rotation_from_vector(turn) * current.root_rotation;
  return smoothed;
}

FixedLag::FixedLag(double neighbor_share) : neighbor_share_(neighbor_share) {
  if (!(neighbor_share >= 0 && neighbor_share <= 0.5))
    throw ConfigError(format("fixed lag: neighbor_share is %g; it must be from 0 to 0.5", neighbor_share));
}

// The waiting frame, which becomes the previous one.
void FixedLag::smooth(const WorkItem* next) {
  if (!is_tracked(waiting_->report.status)) return;
  TrackResult& current = waiting_->result;
  Neighbor captured{current, waiting_->report.pts_ms};
  if (previous_ && next) {
    const double before = captured.pts_ms - previous_->pts_ms, after = next->report.pts_ms - captured.pts_ms;
    if (std::max(before, after) <= kEvenSteps * std::min(before, after)) {
      const TrackResult& previous = previous_->result;
      current.pose = smooth_pose(previous.pose, captured.result.pose, next->result.pose, neighbor_share_);
      const float share = float(neighbor_share_);
      for (size_t i = 0; i < current.vertices_mm.size(); ++i)
        current.vertices_mm[i] +=
            share * (previous.vertices_mm[i] + next->result.vertices_mm[i] - 2 * current.vertices_mm[i]);
    }
  }
  previous_ = std::move(captured);
}

std::optional<WorkItem> FixedLag::push(WorkItem item) {
  if (neighbor_share_ == 0) return item;
  std::optional<WorkItem> ready;
  const bool goes_on = waiting_ && is_tracked(waiting_->report.status) && item.report.status == TrackStatus::kOk &&
                       item.report.index == waiting_->report.index + 1;
  if (waiting_) {
    smooth(goes_on ? &item : nullptr);
    ready = std::move(waiting_);
  }
  if (!goes_on) previous_.reset();
  waiting_ = std::move(item);
  return ready;
}

std::optional<WorkItem> FixedLag::flush() {
  if (waiting_) smooth(nullptr);
  previous_.reset();
  return std::exchange(waiting_, std::nullopt);
}

}  // namespace livecap
