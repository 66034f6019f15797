// What a frame is the mean of once later ones are known (capture/fixed_lag.h).
#pragma once

#include <Eigen/Core>
#include <deque>
#include <functional>
#include <vector>

#include "geometry/skeleton.h"

namespace livecap {

struct LagFrame {
  Pose pose;
  std::vector<float> vertices_mm;
  std::vector<Eigen::Vector3d> joints_mm;  // [n_bones] camera frame
  double pts_ms = 0;
};

// Frames that follow each other without a break, the latest last.
using LagRun = std::deque<LagFrame>;
inline constexpr size_t kMostOfRun = 32;  // older ones are forgotten

// Weights of a run's frames in the mean that stands for frame `at`. [run.size()], sum 1.
using LagWeights = std::function<Eigen::VectorXd(const LagRun& run, size_t at)>;

// The paper's filter of finished videos: [s, 1 - 2s, s] where both neighbours are there, in even steps. s in [0, 0.5].
// Throws ConfigError.
LagWeights neighbor_weights(double neighbor_share);

// Poses that the surface is fitted to. What trembles from frame to frame is network noise and matches that come and
// go. The series x of least sum |x - y|^2 + lambda sum |second differences of x|^2 of a captured one y (Whittaker),
// with lambda from the run itself: how much of what joints were captured with is noise, and how hard they are
// accelerated.
struct SteadyOptions {
  // Of noise by acceleration in lambda. A factor found by trial: noise of neighbouring frames is alike, in part, so
  // that fourth differences see less of it.
  double noise_weight = 16;
  double least = 0.06;  // lambda
  double most = 16;
  double at_first = 1;  // while a run is too short to tell
};
double steady_lambda(const LagRun& run, const SteadyOptions& options);
LagWeights steady_weights(const SteadyOptions& options);

}  // namespace livecap
