#include "capture/lag_weights.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kFrameMs = 1000 / 30.0;

// One joint for each way of moving: where it is in frame i, mm along x.
LagRun run_of(int n_frames, int n_joints, const std::function<double(int frame, int joint)>& x_mm) {
  LagRun run;
  for (int i = 0; i < n_frames; ++i) {
    LagFrame frame;
    frame.pts_ms = kFrameMs * i;
    for (int j = 0; j < n_joints; ++j) frame.joints_mm.emplace_back(x_mm(i, j), 0, 2000);
    run.push_back(frame);
  }
  return run;
}

double mean_x(const LagRun& run, int joint, const Eigen::VectorXd& weights) {
  double sum = 0;
  for (size_t i = 0; i < run.size(); ++i) sum += weights[Eigen::Index(i)] * run[i].joints_mm[joint].x();
  return sum;
}

struct Noise {
  std::mt19937 random{7};
  double operator()(double deviation) { return std::normal_distribution<double>(0, deviation)(random); }
};

double sine(double amplitude_mm, double hertz, int frame, int joint) {
  return amplitude_mm * std::sin(2 * std::numbers::pi * hertz * frame / 30 + joint);
}

TEST(LagWeights, ASharePastHalfIsRefused) {
  EXPECT_THROW(neighbor_weights(0.6), ConfigError);
  EXPECT_THROW(neighbor_weights(-0.1), ConfigError);
}

// Of the stacked residuals x - y and sqrt(lambda) times the second differences of x.
TEST(LagWeights, SteadyOnesAreThoseOfTheLeastSquares) {
  Noise noise;
  for (const int n : {1, 2, 3, 4, 9, 13, 20}) {
    const LagRun run = run_of(n, 5, [&](int i, int j) { return sine(50, 0.8, i, j) + noise(1); });
    for (size_t at = n > 2 ? size_t(n) - 3 : 0; at < size_t(n); ++at) {
      const double lambda = steady_lambda(run, {});
      const Eigen::VectorXd weights = steady_weights({})(run, at);
      ASSERT_EQ(weights.size(), n);
      const int first = std::max(0, int(at) - 12), m = n - first;
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(m + std::max(0, m - 2), m);
      rows.topRows(m).setIdentity();
      for (int i = 0; i + 2 < m; ++i) rows.row(m + i).segment(i, 3) = std::sqrt(lambda) * Eigen::RowVector3d(1, -2, 1);
      const Eigen::MatrixXd solution = rows.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(rows.rows(), m));
      EXPECT_LT((weights.tail(m).transpose() - solution.row(int(at) - first)).norm(), test::kDoubleExact * 100) << n;
      EXPECT_EQ(weights.head(first).norm(), 0);
      EXPECT_NEAR(weights.sum(), 1, test::kDoubleExact * 100);
    }
  }
}

// lambda 1 while a run is short.
TEST(LagWeights, SteadyOnesOfShortRuns) {
  const auto expect_sevenths = [](const LagRun& run, size_t at, const Eigen::VectorXd& wanted) {
    EXPECT_LT((7 * steady_weights({})(run, at) - wanted).norm(), test::kDoubleExact) << run.size() << " " << at;
  };
  const auto still = [](int, int) { return 0.0; };
  expect_sevenths(run_of(1, 1, still), 0, Eigen::VectorXd::Constant(1, 7));
  expect_sevenths(run_of(2, 1, still), 1, Eigen::Vector2d(0, 7));
  expect_sevenths(run_of(3, 1, still), 0, Eigen::Vector3d(6, 2, -1));
  expect_sevenths(run_of(3, 1, still), 1, Eigen::Vector3d(2, 3, 2));
  const Eigen::Vector4d of_four = 33 * steady_weights({})(run_of(4, 1, still), 1);
  EXPECT_LT((of_four - Eigen::Vector4d(10, 14, 8, 1)).norm(), test::kDoubleExact * 10);
  LagRun with_gap = run_of(6, 1, still);
  for (size_t i = 0; i < 6; ++i) with_gap[i].pts_ms = std::array{0, 40, 80, 200, 240, 280}[i];
  expect_sevenths(with_gap, 2, (Eigen::VectorXd(6) << -1, 2, 6, 0, 0, 0).finished());
  expect_sevenths(with_gap, 3, (Eigen::VectorXd(6) << 0, 0, 0, 6, 2, -1).finished());
}

// What moves evenly stays where time stamps tremble, as a webcam's do.
TEST(LagWeights, SteadyOnesKeepAnEvenMotionInUnevenTime) {
  LagRun run = run_of(20, 1, [](int, int) { return 0.0; });
  for (size_t i = 1; i < run.size(); ++i) run[i].pts_ms = run[i - 1].pts_ms + (i % 2 ? 33 : 49);
  for (LagFrame& frame : run) frame.joints_mm[0].x() = 2 * frame.pts_ms;
  EXPECT_EQ(steady_lambda(run, {}), SteadyOptions().least);
  for (const double least : {0.06, 16.0}) {
    const Eigen::VectorXd weights = steady_weights({.least = least})(run, 17);
    EXPECT_GT((weights - Eigen::VectorXd::Unit(20, 17)).norm(), 0.05);
    EXPECT_NEAR(mean_x(run, 0, weights), run[17].joints_mm[0].x(), test::kMillimetreFloat);
  }
}

// On a circle the second differences are 4 sin^2(turn / 2) of the radius, the fourth the square of that.
TEST(LagWeights, LambdaOfACircle) {
  for (const auto& [period, expected] : {std::pair{6, 16.0 / (70 - 6)}, {4, 256.0 / (280 - 96)}}) {
    LagRun run = run_of(12, 1, [](int, int) { return 0.0; });
    for (int i = 0; i < 12; ++i) {
      const double turn = 2 * std::numbers::pi * i / period;
      run[i].joints_mm[0] += 100 * Eigen::Vector3d(std::cos(turn), std::sin(turn), 0);
    }
    EXPECT_NEAR(steady_lambda(run, {}), expected, test::kDoubleExact) << period;
  }
}

// White noise of deviation s on what is accelerated by a, root mean square: noise_weight s^2 / a^2.
TEST(LagWeights, LambdaIsNoiseByAcceleration) {
  constexpr double kHertz = 1.2, kAmplitude = 100, kDeviation = 1.5;
  const double step = 2 * std::numbers::pi * kHertz / 30, acceleration = kAmplitude * step * step / std::numbers::sqrt2;
  Noise noise;
  const LagRun run = run_of(30, 60, [&](int i, int j) { return sine(kAmplitude, kHertz, i, j) + noise(kDeviation); });
  const SteadyOptions options{.noise_weight = 3, .least = 0, .most = 1000};
  const double expected = 3 * std::pow(kDeviation / acceleration, 2);
  EXPECT_GT(expected, 0.1);
  EXPECT_NEAR(steady_lambda(run, options) / expected, 1, test::kSampledVariance);
}

TEST(LagWeights, LambdaHasEndsAndAValueAtFirst) {
  const SteadyOptions options;
  Noise noise;
  const auto of = [&](int n, auto x_mm) { return steady_lambda(run_of(n, 10, x_mm), options); };
  EXPECT_EQ(of(30, [&](int, int) { return noise(1); }), options.most);
  EXPECT_EQ(of(30, [](int i, int j) { return sine(200, 1, i, j); }), options.least);
  EXPECT_EQ(of(30, [](int, int) { return 5.0; }), options.least);
  EXPECT_EQ(of(6, [&](int, int) { return noise(1); }), options.at_first);
  EXPECT_EQ(of(7, [&](int, int) { return noise(1); }), options.most);
}

// Root mean square errors of the third last frame, against captured ones and the filter [9 24 34 24 9] / 100.
TEST(LagWeights, SteadyOnesTakeNoiseAndLeaveWhatIsFast) {
  const auto errors = [](double amplitude_mm, double hertz, double deviation_mm) {
    Noise noise;
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();  // captured, filtered, steady
    const LagRun run =
        run_of(32, 200, [&](int i, int j) { return sine(amplitude_mm, hertz, i, j) + noise(deviation_mm); });
    const Eigen::VectorXd steady = steady_weights({})(run, 29);
    Eigen::VectorXd filter = Eigen::VectorXd::Zero(32);
    filter.tail<5>() << 0.09, 0.24, 0.34, 0.24, 0.09;
    for (int j = 0; j < 200; ++j) {
      const double truth = sine(amplitude_mm, hertz, 29, j);
      const Eigen::Vector3d found(run[29].joints_mm[j].x(), mean_x(run, j, filter), mean_x(run, j, steady));
      squares += (found.array() - truth).square().matrix();
    }
    return Eigen::Vector3d((squares / 200).cwiseSqrt());
  };
  const Eigen::Vector3d still = errors(5, 0.3, 4), fast = errors(250, 1.5, 1);
  EXPECT_LT(still[2], 0.5 * still[0]);
  EXPECT_LT(still[2], still[1]);
  EXPECT_LT(fast[2], fast[0]);
  EXPECT_GT(fast[1], 3 * fast[0]) << "what one width for all does to it";
}

// Evenly moved before a gap of 100 ms and behind it, where nothing is known of what lies in between.
TEST(LagWeights, SteadyOnesDoNotReachOverAGap) {
  LagRun run = run_of(20, 1, [](int i, int) { return i < 10 ? 3.0 * i : 200 - 5.0 * i; });
  for (size_t i = 10; i < run.size(); ++i) run[i].pts_ms += 100;
  for (size_t at = 7; at < 20; ++at)
    EXPECT_NEAR(mean_x(run, 0, steady_weights({})(run, at)), run[at].joints_mm[0].x(), test::kMillimetreFloat) << at;
}

}  // namespace
}  // namespace livecap
