#include "eval/motion_metrics.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "eval/packed_points.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

void require_fps(double fps) {
  if (!(fps > 0) || !std::isfinite(fps)) throw LogicError(format("%g frames per second", fps));
}

std::vector<float> relative_to_centroid(std::vector<float> points) {
  const size_t n = points.size() / 3;
  Vector3d centre = Vector3d::Zero();
  for (size_t i = 0; i < n; ++i) centre += point(points, i) / static_cast<double>(n);
  for (size_t i = 0; i < points.size(); ++i) points[i] -= static_cast<float>(centre[i % 3]);
  return points;
}

}  // namespace

double error_over_truth(const Jitter& jitter) {
  return jitter.n > 0 && jitter.truth > 0 ? jitter.error / jitter.truth : std::numeric_limits<double>::quiet_NaN();
}

JitterMeter::JitterMeter(double fps, bool centred) : fps_(fps), centred_(centred) {
  require_fps(fps);
}

void JitterMeter::add(std::span<const float> estimate, std::span<const float> truth) {
  Points now;
  if (!estimate.empty() && !truth.empty()) {
    if (estimate.size() != truth.size() || (!last_.truth.empty() && truth.size() != last_.truth.size())) {
      throw LogicError(
          format("jitter of %zu and %zu numbers after %zu", estimate.size(), truth.size(), last_.truth.size()));
    }
    now = {{estimate.begin(), estimate.end()}, {truth.begin(), truth.end()}};
    if (centred_) now = {relative_to_centroid(now.estimate), relative_to_centroid(now.truth)};
  }
  if (!now.truth.empty() && !last_.truth.empty() && !before_last_.truth.empty()) {
    const double scale = fps_ * fps_ / 1000;  // mm to m
    for (size_t i = 0; i < now.truth.size() / 3; ++i) {
      const auto acceleration = [&](std::vector<float> Points::*side) -> Vector3d {
        return scale * (point(before_last_.*side, i) - 2 * point(last_.*side, i) + point(now.*side, i));
      };
      const Vector3d ours = acceleration(&Points::estimate);
      const Vector3d theirs = acceleration(&Points::truth);
      if (!ours.allFinite() || !theirs.allFinite()) continue;
      sum_.error += (ours - theirs).norm();
      sum_.captured += ours.norm();
      sum_.truth += theirs.norm();
      ++sum_.n;
    }
  }
  before_last_ = std::move(last_);
  last_ = std::move(now);
}

Jitter JitterMeter::result() const {
  Jitter mean = sum_;
  if (mean.n == 0) return mean;
  for (double* value : {&mean.error, &mean.captured, &mean.truth}) *value /= static_cast<double>(mean.n);
  return mean;
}

FootSlide foot_slide(const std::vector<std::vector<float>>& estimate, const std::vector<std::vector<float>>& truth,
                     double fps) {
  require_fps(fps);
  if (estimate.size() != truth.size()) {
    throw LogicError(format("foot of %zu and %zu frames", estimate.size(), truth.size()));
  }
  const int64_t n = static_cast<int64_t>(truth.size());
  const int64_t reach = std::max<int64_t>(1, std::llround(kPlantedS * fps));
  const auto planted = [&](int64_t t) {
    if (t - reach < 0 || t + reach >= n || truth[t].empty()) return false;
    for (int64_t other = t - reach; other <= t + reach; ++other) {
      if (truth[other].empty() || (point(truth[other], 0) - point(truth[t], 0)).norm() > kPlantedMm) return false;
    }
    return true;
  };
  const auto speed = [&](const std::vector<std::vector<float>>& foot, int64_t t) {
    const Vector3d step = point(foot[t], 0) - point(foot[t - 1], 0);
    return fps * std::hypot(step.x(), step.z());
  };
  FootSlide slide;
  for (int64_t t = 1; t < n; ++t) {
    if (estimate[t].empty() || estimate[t - 1].empty() || !planted(t - 1) || !planted(t)) continue;
    slide.mm_per_s += speed(estimate, t);
    slide.truth_mm_per_s += speed(truth, t);
    ++slide.n;
  }
  if (slide.n > 0) {
    slide.mm_per_s /= static_cast<double>(slide.n);
    slide.truth_mm_per_s /= static_cast<double>(slide.n);
  }
  return slide;
}

FootSlide combined(const FootSlide& a, const FootSlide& b) {
  FootSlide sum;
  sum.n = a.n + b.n;
  if (sum.n == 0) return sum;
  const double share = static_cast<double>(a.n) / static_cast<double>(sum.n);
  sum.mm_per_s = share * a.mm_per_s + (1 - share) * b.mm_per_s;
  sum.truth_mm_per_s = share * a.truth_mm_per_s + (1 - share) * b.truth_mm_per_s;
  return sum;
}

Losses count_losses(const std::vector<bool>& person, const std::vector<bool>& tracked) {
  if (person.size() != tracked.size()) {
    throw LogicError(format("presence of %zu frames, tracking of %zu", person.size(), tracked.size()));
  }
  Losses losses;
  bool entered = false;  // tracked since the person appeared
  int64_t run = 0;       // untracked frames on end with the person there
  for (size_t t = 0; t < person.size(); ++t) {
    if (!person[t]) {
      entered = false;
      run = 0;
    } else if (tracked[t]) {
      if (entered && run > 0) ++losses.n_recovered;
      entered = true;
      run = 0;
    } else {
      ++losses.lost;
      ++run;
      if (entered && run == 1) ++losses.n_losses;
      int64_t& longest = entered ? losses.longest : losses.longest_entry;
      longest = std::max(longest, run);
    }
  }
  return losses;
}

}  // namespace livecap
