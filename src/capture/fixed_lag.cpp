#include "capture/fixed_lag.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kFastestMmPerMs = 8;  // of an ankle or an elbow

LagFrame as_it_came(const Skeleton& skeleton, const WorkItem& item) {
  LagFrame frame{item.result.pose, item.result.vertices_mm, {}, item.report.pts_ms};
  for (const Eigen::Isometry3d& camera_from_bone : forward_kinematics(skeleton, frame.pose).camera_from_bone)
    frame.joints_mm.push_back(camera_from_bone.translation());
  return frame;
}

// Whether a joint moves faster than people do: the tracker has thought better of it. Halfway between a wrong leg and
// the right one there is none.
bool jumps(const LagFrame& before, const LagFrame& after) {
  for (size_t j = 0; j < after.joints_mm.size(); ++j) {
    const double farthest = kFastestMmPerMs * (after.pts_ms - before.pts_ms);
    if (!((after.joints_mm[j] - before.joints_mm[j]).norm() <= farthest)) return true;
  }
  return false;
}

}  // namespace

Pose weighted_pose(const LagRun& run, size_t at, const Eigen::VectorXd& weights) {
  Pose mean = run[at].pose;
  const Pose current = mean;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  const auto add_side = [&](int step) {
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    for (size_t i = at + size_t(step); i < run.size(); i += size_t(step)) {  // below 0 it wraps around
      way += vector_from_rotation(run[i].pose.root_rotation * run[i - size_t(step)].pose.root_rotation.transpose());
      const double weight = weights[Eigen::Index(i)];
      turn += weight * way;
      mean.root_translation_mm += weight * (run[i].pose.root_translation_mm - current.root_translation_mm);
      mean.angles_rad += weight * (run[i].pose.angles_rad - current.angles_rad);
    }
  };
  add_side(-1);
  add_side(1);
  mean.root_rotation = rotation_from_vector(turn) * current.root_rotation;
  return mean;
}

FixedLag::FixedLag(const Skeleton& skeleton, int lag, LagWeights weights)
    : skeleton_(&skeleton), lag_(size_t(lag)), weights_(std::move(weights)) {
  if (lag < 0 || lag_ >= kMostOfRun)
    throw ConfigError(format("fixed lag: lag is %d; it must be from 0 to %d", lag, int(kMostOfRun) - 1));
}

void FixedLag::smooth(WorkItem& item, size_t at) const {
  const Eigen::VectorXd weights = weights_(run_, at);
  item.result.pose = weighted_pose(run_, at, weights);
  std::vector<float>& mean = item.result.vertices_mm;
  std::fill(mean.begin(), mean.end(), 0.0f);
  for (size_t i = 0; i < run_.size(); ++i) {
    const float weight = static_cast<float>(weights[static_cast<Eigen::Index>(i)]);
    if (weight == 0) continue;
    for (size_t k = 0; k < mean.size(); ++k) mean[k] += weight * run_[i].vertices_mm[k];
  }
}

// No further frame will come for those that wait.
void FixedLag::end_run() {
  for (; n_open_ > 0; --n_open_) smooth(waiting_[waiting_.size() - n_open_], run_.size() - n_open_);
  run_.clear();
}

bool FixedLag::goes_on(const WorkItem& item, const LagFrame& frame) const {
  return n_open_ > 0 && item.report.status == TrackStatus::kOk &&
         item.report.index == waiting_.back().report.index + 1 && !jumps(run_.back(), frame);
}

std::optional<WorkItem> FixedLag::take_first() {
  if (n_open_ == waiting_.size()) {
    smooth(waiting_.front(), run_.size() - n_open_);
    --n_open_;
  }
  std::optional<WorkItem> first = std::move(waiting_.front());
  waiting_.pop_front();
  return first;
}

std::optional<WorkItem> FixedLag::push(WorkItem item) {
  if (lag_ == 0) return item;
  const bool tracked = is_tracked(item.report.status);
  LagFrame frame;
  if (tracked) frame = as_it_came(*skeleton_, item);
  if (!tracked || !goes_on(item, frame)) end_run();
  waiting_.push_back(std::move(item));
  if (tracked) {
    run_.push_back(std::move(frame));
    if (run_.size() > kMostOfRun) run_.pop_front();
    ++n_open_;
  }
  return waiting_.size() > lag_ ? take_first() : std::nullopt;
}

std::optional<WorkItem> FixedLag::flush() {
  return waiting_.empty() ? std::nullopt : take_first();
}

}  // namespace livecap
