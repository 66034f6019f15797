#include "capture/fixed_lag.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kEvenSteps = 1.5;     // one time step by the other
constexpr double kFastestMmPerMs = 8;  // of an ankle or an elbow

// Whether a joint moves faster than people do: the tracker has thought better of it. Halfway between a wrong leg and
// the right one there is none.
bool jumps(const Skeleton& skeleton, const WorkItem& before, const WorkItem& after) {
  const PosedSkeleton a = forward_kinematics(skeleton, before.result.pose);
  const PosedSkeleton b = forward_kinematics(skeleton, after.result.pose);
  double farthest_mm = 0;
  for (int bone = 0; bone < skeleton.n_bones(); ++bone)
    farthest_mm =
        std::max(farthest_mm, (b.camera_from_bone[bone].translation() - a.camera_from_bone[bone].translation()).norm());
  return farthest_mm > kFastestMmPerMs * (after.report.pts_ms - before.report.pts_ms);
}

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

// The waiting frame, which becomes the previous one.
void FixedLag::Pass::smooth(const WorkItem* next) {
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

std::optional<WorkItem> FixedLag::Pass::push(WorkItem item) {
  std::optional<WorkItem> ready;
  const bool goes_on = waiting_ && is_tracked(waiting_->report.status) && item.report.status == TrackStatus::kOk &&
                       item.report.index == waiting_->report.index + 1 && !jumps(*skeleton_, *waiting_, item);
  if (waiting_) {
    smooth(goes_on ? &item : nullptr);
    ready = std::move(waiting_);
  }
  if (!goes_on) previous_.reset();
  waiting_ = std::move(item);
  return ready;
}

std::optional<WorkItem> FixedLag::Pass::flush() {
  if (waiting_) smooth(nullptr);
  previous_.reset();
  return std::exchange(waiting_, std::nullopt);
}

FixedLag::FixedLag(const Skeleton& skeleton, double neighbor_share, int passes) {
  if (!(neighbor_share >= 0 && neighbor_share <= 0.5))
    throw ConfigError(format("fixed lag: neighbor_share is %g; it must be from 0 to 0.5", neighbor_share));
  if (passes < 1) throw ConfigError(format("fixed lag: passes is %d; at least 1 is needed", passes));
  if (neighbor_share > 0) passes_.assign(passes, Pass(skeleton, neighbor_share));
}

std::optional<WorkItem> FixedLag::push(WorkItem item) {
  std::optional<WorkItem> ready = std::move(item);
  for (Pass& pass : passes_) {
    ready = pass.push(std::move(*ready));
    if (!ready) break;
  }
  return ready;
}

// What leaves a pass at its end still goes through those behind it.
std::optional<WorkItem> FixedLag::flush() {
  std::optional<WorkItem> ready;
  for (Pass& pass : passes_) {
    if (ready) ready = pass.push(std::move(*ready));
    if (!ready) ready = pass.flush();
  }
  return ready;
}

}  // namespace livecap
