#include "capture/lag_weights.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kEvenSteps = 1.5;  // one time step by the other
constexpr size_t kReach = 12;       // frames before that still count
// Variance of the second and fourth differences of white noise by its own: sums of squares of 1 -2 1 and 1 -4 6 -4 1.
constexpr double kSecondGain = 6, kFourthGain = 70;
constexpr int kFewest = 3;          // fourth differences that tell of noise
constexpr double kStillMm2 = 1e-6;  // second differences squared: what is less is rounding

// Whether the steps before and after frame i of a run, which is neither its first nor its last, are alike.
bool is_even(const LagRun& run, size_t i) {
  const double before = run[i].pts_ms - run[i - 1].pts_ms, after = run[i + 1].pts_ms - run[i].pts_ms;
  return std::max(before, after) <= kEvenSteps * std::min(before, after);
}

// The second difference about frame i by frames i - 1, i and i + 1: 0 for what moves evenly in time, 1 -2 1 for even
// steps. Over uneven ones nothing.
Eigen::RowVector3d second_difference(const LagRun& run, size_t i) {
  const double before = run[i].pts_ms - run[i - 1].pts_ms, after = run[i + 1].pts_ms - run[i].pts_ms;
  if (!is_even(run, i) || !(before > 0)) return Eigen::RowVector3d::Zero();
  const double first = 2 * after / (before + after), last = 2 * before / (before + after);
  return {first, -first - last, last};
}

Eigen::VectorXd itself(const LagRun& run, size_t at) {
  return Eigen::VectorXd::Unit(Eigen::Index(run.size()), Eigen::Index(at));
}

}  // namespace

LagWeights neighbor_weights(double neighbor_share) {
  if (!(neighbor_share >= 0 && neighbor_share <= 0.5))
    throw ConfigError(format("fixed lag: neighbor_share is %g; it must be from 0 to 0.5", neighbor_share));
  return [neighbor_share](const LagRun& run, size_t at) {
    Eigen::VectorXd weights = itself(run, at);
    if (at == 0 || at + 1 >= run.size() || !is_even(run, at)) return weights;
    weights.segment<3>(Eigen::Index(at) - 1) << neighbor_share, 1 - 2 * neighbor_share, neighbor_share;
    return weights;
  };
}

double steady_lambda(const LagRun& run, const SteadyOptions& options) {
  double second = 0, fourth = 0;
  int n = 0;  // of all joints each
  for (size_t i = 4; i < run.size(); ++i) {
    if (!is_even(run, i - 1) || !is_even(run, i - 2) || !is_even(run, i - 3)) continue;
    ++n;
    for (size_t joint = 0; joint < run[i].joints_mm.size(); ++joint) {
      const auto difference = [&](size_t about) -> Eigen::Vector3d {
        const Eigen::RowVector3d by = second_difference(run, about);
        return by[0] * run[about - 1].joints_mm[joint] + by[1] * run[about].joints_mm[joint] +
               by[2] * run[about + 1].joints_mm[joint];
      };
      const Eigen::Vector3d last = difference(i - 1);
      second += last.squaredNorm();
      fourth += (last - 2 * difference(i - 2) + difference(i - 3)).squaredNorm();
    }
  }
  if (n < kFewest) return options.at_first;
  const double noise = fourth / kFourthGain, still = kStillMm2 * n * double(run.back().joints_mm.size());
  const double acceleration = std::max(second - kSecondGain * noise, still);
  return std::clamp(options.noise_weight * noise / acceleration, options.least, options.most);
}

LagWeights steady_weights(const SteadyOptions& options) {
  return [options](const LagRun& run, size_t at) {
    const size_t first = at > kReach ? at - kReach : 0;
    const Eigen::Index n = Eigen::Index(run.size() - first);
    const double lambda = steady_lambda(run, options);
    Eigen::MatrixXd system = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i + 2 < n; ++i) {
      const Eigen::RowVector3d difference = second_difference(run, first + size_t(i) + 1);
      system.block<3, 3>(i, i) += lambda * difference.transpose() * difference;
    }
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(Eigen::Index(run.size()));
    weights.tail(n) = system.ldlt().solve(Eigen::VectorXd::Unit(n, Eigen::Index(at - first)));
    return weights;
  };
}

}  // namespace livecap
