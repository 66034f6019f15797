#include "eval/metrics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "eval/packed_points.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using Points = Eigen::Matrix3Xd;

Points to_points(std::span<const float> packed) {
  return Eigen::Map<const Eigen::Matrix3Xf>(packed.data(), 3, static_cast<Eigen::Index>(packed.size() / 3))
      .cast<double>();
}

std::vector<double> column_norms(const Points& difference) {
  std::vector<double> norms(difference.cols());
  for (Eigen::Index i = 0; i < difference.cols(); ++i) norms[i] = difference.col(i).norm();
  return norms;
}

// q in [0,1] of an ascending list.
double quantile(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const size_t below = static_cast<size_t>(position);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

std::vector<double> point_distances(std::span<const float> estimate, std::span<const float> truth) {
  require_same_points(estimate, truth);
  return column_norms(to_points(estimate) - to_points(truth));
}

std::vector<double> translation_aligned_distances(std::span<const float> estimate, std::span<const float> truth) {
  require_same_points(estimate, truth);
  if (estimate.empty()) return {};
  const Points difference = to_points(estimate) - to_points(truth);
  return column_norms(difference.colwise() - difference.rowwise().mean());
}

std::vector<double> similarity_aligned_distances(std::span<const float> estimate, std::span<const float> truth) {
  require_same_points(estimate, truth);
  if (estimate.size() < 9) throw LogicError("a similarity alignment needs at least three points");
  const Points from = to_points(estimate);
  const Points to = to_points(truth);
  const Points from_centred = from.colwise() - from.rowwise().mean();
  if (from_centred.squaredNorm() == 0) return translation_aligned_distances(estimate, truth);
  const Eigen::Matrix4d transform = Eigen::umeyama(from, to, true);
  const Points moved = (transform.topLeftCorner<3, 3>() * from).colwise() + transform.topRightCorner<3, 1>();
  return column_norms(moved - to);
}

Summary summarize(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  Summary summary;
  summary.n = static_cast<int64_t>(values.size());
  if (values.empty()) return summary;
  std::sort(values.begin(), values.end());
  summary.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  summary.median = quantile(values, 0.5);
  summary.p05 = quantile(values, 0.05);
  summary.p95 = quantile(values, 0.95);
  summary.min = values.front();
  summary.max = values.back();
  return summary;
}

double mean_or_nan(const Summary& summary) {
  return summary.n > 0 ? summary.mean : std::numeric_limits<double>::quiet_NaN();
}

double mean_of(std::vector<double> values) {
  return mean_or_nan(summarize(std::move(values)));
}

}  // namespace livecap
