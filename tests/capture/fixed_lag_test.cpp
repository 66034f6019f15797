#include "capture/fixed_lag.h"

#include <gtest/gtest.h>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A thigh and a shank of 400 mm.
Skeleton leg() {
  Skeleton skeleton;
  skeleton.bones = {{"root", -1, {0, 0, 0}}, {"knee", 0, {0, -400, 0}}, {"ankle", 1, {0, -400, 0}}};
  skeleton.dofs = {{"root_x", 0, {1, 0, 0}, -10, 10, 0}, {"knee_x", 1, {1, 0, 0}, -10, 10, 0}};
  return skeleton;
}

const Skeleton kLeg = leg();
constexpr double kRadPerUnit = 0.01;

WorkItem frame(int64_t index, float value, TrackStatus status = TrackStatus::kOk) {
  WorkItem item;
  item.report.index = index;
  item.report.pts_ms = 40.0 * double(index);
  item.report.status = status;
  if (!is_tracked(status)) return item;
  item.result.vertices_mm = {value, -value, 1};
  item.result.pose.angles_rad = Eigen::VectorXd::Constant(2, kRadPerUnit * value);
  item.result.pose.root_translation_mm = Eigen::Vector3d(value, 0, 1000);
  return item;
}

// First vertex coordinate and first angle (in units) of every frame that comes out, in order.
std::vector<std::pair<float, double>> filtered(int lag, const LagWeights& weights, std::vector<WorkItem> items) {
  FixedLag waits(kLeg, lag, weights);
  std::vector<std::pair<float, double>> out;
  int64_t index = items.empty() ? 0 : items.front().report.index;
  const auto take = [&](const WorkItem& item) {
    EXPECT_EQ(item.report.index, index);
    index = item.report.index + 1;
    const bool tracked = is_tracked(item.report.status);
    out.emplace_back(tracked ? item.result.vertices_mm[0] : -1.0f,
                     tracked ? item.result.pose.angles_rad[0] / kRadPerUnit : -1.0);
  };
  for (size_t i = 0; i < items.size(); ++i) {
    if (const auto ready = waits.push(std::move(items[i]))) take(*ready);
    EXPECT_EQ(out.size(), i + 1 - std::min(i + 1, size_t(lag)));
  }
  while (const auto last = waits.flush()) take(*last);
  return out;
}

std::vector<std::pair<float, double>> filtered(double share, std::vector<WorkItem> items) {
  return filtered(1, neighbor_weights(share), std::move(items));
}

void expect(const std::vector<std::pair<float, double>>& got, const std::vector<double>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_FLOAT_EQ(got[i].first, float(wanted[i])) << i;
    EXPECT_NEAR(got[i].second, wanted[i], test::kDoubleExact) << i;
  }
}

TEST(FixedLag, AnImpulseSpreadsAndTheEndsStay) {
  expect(filtered(0.15, {frame(0, 0), frame(1, 0), frame(2, 1), frame(3, 0), frame(4, 2)}), {0, 0.15, 0.7, 0.45, 2});
  expect(filtered(0.25, {frame(0, 4)}), {4});
  expect(filtered(0.25, {}), {});
}

TEST(FixedLag, WithoutLagEverythingPassesAsItIs) {
  expect(filtered(0, neighbor_weights(0.25), {frame(0, 1), frame(1, 5), frame(2, 2)}), {1, 5, 2});
}

// Weights by how many frames of the run come before and after: what a frame may be the mean of.
TEST(FixedLag, AFrameKnowsItsRunAndAsManyLaterFramesAsItWaitsFor) {
  std::vector<std::pair<size_t, size_t>> asked;  // of the run: frames, which one
  const LagWeights weights = [&](const LagRun& run, size_t at) {
    asked.emplace_back(run.size(), at);
    return Eigen::VectorXd::Unit(Eigen::Index(run.size()), Eigen::Index(at)).eval();
  };
  using enum TrackStatus;
  std::vector<WorkItem> items;
  for (int i = 0; i < 4; ++i) items.push_back(frame(i, float(i)));
  items.push_back(frame(4, 0, kNobody));
  items.push_back(frame(5, 5, kInitialized));
  expect(filtered(2, weights, std::move(items)), {0, 1, 2, 3, -1, 5});
  EXPECT_EQ(asked, (std::vector<std::pair<size_t, size_t>>{{3, 0}, {4, 1}, {4, 2}, {4, 3}, {1, 0}}));

  asked.clear();
  items.clear();
  const size_t n = kMostOfRun + 5;
  for (size_t i = 0; i < n; ++i) items.push_back(frame(int64_t(i), 1));
  filtered(2, weights, std::move(items));
  EXPECT_EQ(asked.back(), (std::pair<size_t, size_t>{kMostOfRun, kMostOfRun - 1}));
  EXPECT_EQ(asked[n - 3], (std::pair<size_t, size_t>{kMostOfRun, kMostOfRun - 3}));
}

TEST(FixedLag, LinearMotionStays) {
  expect(filtered(0.25, {frame(3, 1), frame(4, 2), frame(5, 3), frame(6, 4)}), {1, 2, 3, 4});
}

TEST(FixedLag, BreaksAreNotSmoothedOver) {
  using enum TrackStatus;
  // Nobody in between, a track that begins anew, and frames that live pacing dropped.
  expect(filtered(0.25, {frame(0, 0), frame(1, 4), frame(2, 0, kNobody), frame(3, 8, kInitialized), frame(4, 4)}),
         {0, 4, -1, 8, 4});
  expect(filtered(0.25, {frame(0, 0), frame(1, 4), frame(2, 8, kInitialized), frame(3, 8), frame(4, 0)}),
         {0, 4, 8, 6, 0});
  FixedLag lag(kLeg, 1, neighbor_weights(0.25));
  lag.push(frame(0, 0));
  EXPECT_EQ(lag.push(frame(5, 8))->result.vertices_mm[0], 0);
  EXPECT_EQ(lag.flush()->result.vertices_mm[0], 8);
}

// By lambda 1: neighbours as they came, two of them behind.
TEST(FixedLag, SteadyPosesAreMeansOfWhatWasCaptured) {
  expect(filtered(2, steady_weights({}), {frame(0, 0), frame(1, 0), frame(2, 21), frame(3, 0)}),
         {-3, 21 * 8 / 33.0, 21 * 14 / 33.0, 21 * 10 / 33.0});
}

TEST(FixedLag, ALagOfARunOrMoreIsRefused) {
  EXPECT_THROW(FixedLag(kLeg, -1, neighbor_weights(0.25)), ConfigError);
  EXPECT_THROW(FixedLag(kLeg, int(kMostOfRun), neighbor_weights(0.25)), ConfigError);
}

// A video with a gap: frame 2 comes 100 ms late.
TEST(FixedLag, AFrameBesideAGapInTimeIsNotMovedAlong) {
  std::vector<WorkItem> items;
  for (int i = 0; i < 6; ++i) {
    items.push_back(frame(i, float(i < 2 ? i : i + 3)));
    items.back().report.pts_ms = 33 * (i < 2 ? i : i + 3);
  }
  items[4].result.vertices_mm[0] = 11;  // not on the line: smoothed
  items[4].result.pose.angles_rad[0] = 11 * kRadPerUnit;
  expect(filtered(0.25, std::move(items)), {0, 1, 5, 7, 9, 8});
}

// The knee bends by 1 rad: the ankle moves by 383 mm in 40 ms, faster than 8 m/s. By 0.7 rad it is 274 mm.
TEST(FixedLag, AJumpIsNotSmoothedOver) {
  const auto bent = [](int64_t index, double knee_rad) {
    WorkItem item = frame(index, 0);
    item.result.pose.angles_rad[1] = knee_rad;
    return item;
  };
  for (const auto& [knee_rad, smoothed] : {std::pair{1.0, false}, {0.7, true}}) {
    FixedLag lag(kLeg, 1, neighbor_weights(0.25));
    std::vector<double> knees;
    const auto take = [&](std::optional<WorkItem> item) {
      if (item) knees.push_back(item->result.pose.angles_rad[1]);
    };
    for (int i = 0; i < 5; ++i) take(lag.push(bent(i, i < 2 ? 0.0 : knee_rad)));
    take(lag.flush());
    ASSERT_EQ(knees.size(), 5u);
    EXPECT_NEAR(knees[1], smoothed ? knee_rad / 4 : 0.0, test::kDoubleExact);
    EXPECT_NEAR(knees[2], smoothed ? knee_rad * 3 / 4 : knee_rad, test::kDoubleExact);
  }
}

// Frames with the root turned about Y by the angles, rad.
LagRun turned(const std::vector<double>& angles_rad) {
  LagRun run;
  for (const double angle : angles_rad) {
    LagFrame frame;
    frame.pose.angles_rad = Eigen::VectorXd::Zero(1);
    frame.pose.root_rotation = rotation_from_vector({0, angle, 0}) * rotation_from_vector(Eigen::Vector3d(0.1, 0.2, 0));
    run.push_back(frame);
  }
  return run;
}

TEST(FixedLag, TurnsAreMeansOfTheWayEvenOnceAround) {
  const auto expect_turn = [](const std::vector<double>& angles_rad, size_t at, const Eigen::VectorXd& weights,
                              double wanted_rad) {
    const Pose mean = weighted_pose(turned(angles_rad), at, weights);
    EXPECT_LT((mean.root_rotation - turned({wanted_rad})[0].pose.root_rotation).norm(), test::kDoubleExact);
  };
  expect_turn({-0.3, 0, 0.3}, 1, Eigen::Vector3d(0.25, 0.5, 0.25), 0);
  expect_turn({0, 0, 0.4}, 1, Eigen::Vector3d(0, 0.5, 0.5), 0.2);
  expect_turn({0, 0, 0.4}, 0, Eigen::Vector3d(0, 0.5, 0.5), 0.2);
  expect_turn({0, 1, 2, 3, 4}, 0, Eigen::VectorXd::Unit(5, 4), 4);
  expect_turn({0, -1, -2, -3, -4}, 4, Eigen::VectorXd::Unit(5, 0), 0);
}

}  // namespace
}  // namespace livecap
