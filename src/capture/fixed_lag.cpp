#include "capture/fixed_lag.h"

#include <utility>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

Pose smooth_pose(const Pose* previous, const Pose& current, const Pose* next, double neighbor_share) {
  Pose smoothed = current;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (const Pose* neighbor : {previous, next}) {
    if (!neighbor) continue;
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

void FixedLag::smooth(const TrackResult* next) {
  if (!is_tracked(waiting_->report.status)) return;
  const TrackResult* previous = previous_ ? &*previous_ : nullptr;
  TrackResult& current = waiting_->result;
  const TrackResult captured = current;
  current.pose =
      smooth_pose(previous ? &previous->pose : nullptr, captured.pose, next ? &next->pose : nullptr, neighbor_share_);
  const float share = float(neighbor_share_);
  for (const TrackResult* neighbor : {previous, next}) {
    if (!neighbor) continue;
    for (size_t i = 0; i < current.vertices_mm.size(); ++i)
      current.vertices_mm[i] += share * (neighbor->vertices_mm[i] - captured.vertices_mm[i]);
  }
  previous_ = captured;
}

std::optional<WorkItem> FixedLag::push(WorkItem item) {
  if (neighbor_share_ == 0) return item;
  std::optional<WorkItem> ready;
  const bool goes_on = waiting_ && is_tracked(waiting_->report.status) && item.report.status == TrackStatus::kOk &&
                       item.report.index == waiting_->report.index + 1;
  if (waiting_) {
    smooth(goes_on ? &item.result : nullptr);
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
