#include "capture/fixed_lag.h"

#include <gtest/gtest.h>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

WorkItem frame(int64_t index, float value, TrackStatus status = TrackStatus::kOk) {
  WorkItem item;
  item.report.index = index;
  item.report.pts_ms = 40.0 * double(index);
  item.report.status = status;
  if (!is_tracked(status)) return item;
  item.result.vertices_mm = {value, -value, 1};
  item.result.pose.angles_rad = Eigen::VectorXd::Constant(2, value);
  item.result.pose.root_translation_mm = Eigen::Vector3d(value, 0, 1000);
  return item;
}

// First vertex coordinate and first angle of every frame that comes out, in order.
std::vector<std::pair<float, double>> filtered(double share, std::vector<WorkItem> items) {
  FixedLag lag(share);
  std::vector<std::pair<float, double>> out;
  int64_t index = items.empty() ? 0 : items.front().report.index;
  const auto take = [&](const WorkItem& item) {
    EXPECT_EQ(item.report.index, index);
    index = item.report.index + 1;
    const bool tracked = is_tracked(item.report.status);
    out.emplace_back(tracked ? item.result.vertices_mm[0] : -1.0f, tracked ? item.result.pose.angles_rad[0] : -1.0);
  };
  for (WorkItem& item : items)
    if (const auto ready = lag.push(std::move(item))) take(*ready);
  if (const auto last = lag.flush()) take(*last);
  EXPECT_FALSE(lag.flush().has_value());
  return out;
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
  expect(filtered(0, {frame(0, 1), frame(1, 5), frame(2, 2)}), {1, 5, 2});
  expect(filtered(0.25, {}), {});
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
  FixedLag lag(0.25);
  lag.push(frame(0, 0));
  EXPECT_EQ(lag.push(frame(5, 8))->result.vertices_mm[0], 0);
  EXPECT_EQ(lag.flush()->result.vertices_mm[0], 8);
}

// A video with a gap: frame 2 comes 100 ms late.
TEST(FixedLag, AFrameBesideAGapInTimeIsNotMovedAlong) {
  std::vector<WorkItem> items;
  for (int i = 0; i < 6; ++i) {
    items.push_back(frame(i, float(i < 2 ? i : i + 3)));
    items.back().report.pts_ms = 33 * (i < 2 ? i : i + 3);
  }
  items[4].result.vertices_mm[0] = 11;  // not on the line: smoothed
  items[4].result.pose.angles_rad[0] = 11;
  expect(filtered(0.25, std::move(items)), {0, 1, 5, 7, 9, 8});
}

TEST(FixedLag, AnEvenTurnStaysAndAJerkIsHalved) {
  const auto turned = [](double angle) {
    Pose pose;
    pose.angles_rad = Eigen::VectorXd::Zero(1);
    pose.root_translation_mm.setZero();
    pose.root_rotation = rotation_from_vector(Eigen::Vector3d(0.1, angle, 0));
    return pose;
  };
  const auto about_y = [](double angle) { return rotation_from_vector(Eigen::Vector3d(0, angle, 0)); };
  Pose before = turned(0), now = turned(0), after = turned(0);
  before.root_rotation = about_y(-0.3) * now.root_rotation;
  after.root_rotation = about_y(0.3) * now.root_rotation;
  EXPECT_LT((smooth_pose(before, now, after, 0.25).root_rotation - now.root_rotation).norm(), test::kDoubleExact);
  const Pose still = turned(0);
  Pose jerk = still;
  jerk.root_rotation = about_y(0.4) * still.root_rotation;
  EXPECT_LT((smooth_pose(still, jerk, still, 0.25).root_rotation - about_y(0.2) * still.root_rotation).norm(),
            test::kDoubleExact);
}

TEST(FixedLag, ASharePastHalfIsRefused) {
  EXPECT_THROW(FixedLag(0.6), ConfigError);
  EXPECT_THROW(FixedLag(-0.1), ConfigError);
}

}  // namespace
}  // namespace livecap
