#include "eval/pose_metrics.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "eval/packed_points.h"
#include "geometry/segment.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

constexpr double kPckStepMm = 5;

// From a point to the segment between a and b.
double distance_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  return (p - a - segment_parameter(p, a, b) * (b - a)).norm();
}

}  // namespace

std::vector<double> root_aligned_distances(std::span<const float> estimate, std::span<const float> truth, int root) {
  require_same_points(estimate, truth);
  const int n = static_cast<int>(truth.size() / 3);
  if (root < 0 || root >= n) throw LogicError(format("root %d of %d points", root, n));
  const Vector3d offset = point(truth, root) - point(estimate, root);
  std::vector<double> distances;
  for (int i = 0; i < n; ++i) {
    if (i != root) distances.push_back((point(estimate, i) + offset - point(truth, i)).norm());
  }
  return distances;
}

double share_within(std::span<const double> distances_mm, double threshold_mm) {
  if (distances_mm.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto within =
      std::count_if(distances_mm.begin(), distances_mm.end(), [&](double d) { return d <= threshold_mm; });
  return static_cast<double>(within) / static_cast<double>(distances_mm.size());
}

double area_under_pck(std::span<const double> distances_mm) {
  if (distances_mm.empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  int n = 0;
  for (double threshold = 0; threshold <= kPckMm; threshold += kPckStepMm, ++n) {
    sum += share_within(distances_mm, threshold);
  }
  return sum / n;
}

bool sides_exchanged(std::span<const float> estimate, std::span<const float> truth, const SidePairs& pairs) {
  require_same_points(estimate, truth);
  if (pairs.empty()) return false;
  const int n = static_cast<int>(truth.size() / 3);
  Vector3d offset = Vector3d::Zero();
  for (int i = 0; i < n; ++i) offset += (point(truth, i) - point(estimate, i)) / n;
  double as_named = 0;
  double exchanged = 0;
  for (const auto& [left, right] : pairs) {
    const Vector3d at_left = point(estimate, left) + offset;
    const Vector3d at_right = point(estimate, right) + offset;
    as_named += (at_left - point(truth, left)).norm() + (at_right - point(truth, right)).norm();
    exchanged += (at_left - point(truth, right)).norm() + (at_right - point(truth, left)).norm();
  }
  const double mean_mm = as_named / (2 * static_cast<double>(pairs.size()));
  return mean_mm >= kExchangeMm && exchanged <= as_named / 2;
}

bool limb_inside_trunk(std::span<const float> estimate, std::span<const float> truth, int root, int neck,
                       std::span<const int> points) {
  require_same_points(estimate, truth);
  return std::any_of(points.begin(), points.end(), [&](int i) {
    return distance_to_segment(point(estimate, i), point(estimate, root), point(estimate, neck)) < kInsideTrunkMm &&
           distance_to_segment(point(truth, i), point(truth, root), point(truth, neck)) >= kOutsideTrunkMm;
  });
}

bool at_limit(double angle_deg, double min_deg, double max_deg) {
  return angle_deg <= min_deg + kLimitDeg || angle_deg >= max_deg - kLimitDeg;
}

}  // namespace livecap
