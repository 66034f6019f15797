// Joint scores against values worked out by hand.
#include "eval/pose_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::kDoubleExact;

TEST(PoseMetrics, RootAlignmentPutsTheRootsTogetherAndLeavesThemOut) {
  // Point 1 is the root, off by (10,0,0). Point 0 is off by the same: distance 0. Point 2 by (13,4,0): 5 remain.
  const std::vector<float> estimate = {10, 0, 0, 110, 0, 0, 13, 54, 7};
  const std::vector<float> truth = {0, 0, 0, 100, 0, 0, 0, 50, 7};
  EXPECT_EQ(root_aligned_distances(estimate, truth, 1), (std::vector<double>{0, 5}));
  EXPECT_THROW(root_aligned_distances(estimate, truth, 3), LogicError);
  EXPECT_THROW(root_aligned_distances(estimate, truth, -1), LogicError);
  EXPECT_THROW(root_aligned_distances(estimate, std::vector<float>(6), 0), LogicError);
}

TEST(PoseMetrics, PckCountsTheThresholdInAndMissingResultsOut) {
  const std::vector<double> distances = {0, 150, 150.001, std::numeric_limits<double>::infinity(),
                                         std::numeric_limits<double>::quiet_NaN()};
  EXPECT_DOUBLE_EQ(share_within(distances), 2.0 / 5);
  EXPECT_DOUBLE_EQ(share_within(distances, 151), 3.0 / 5);
  EXPECT_TRUE(std::isnan(share_within({})));
}

TEST(PoseMetrics, AucIsTheMeanOverTheThirtyOneThresholds) {
  EXPECT_NEAR(area_under_pck(std::vector<double>{0}), 1, kDoubleExact);
  EXPECT_NEAR(area_under_pck(std::vector<double>{150}), 1.0 / 31, kDoubleExact);     // at 150 only
  EXPECT_NEAR(area_under_pck(std::vector<double>{100}), 11.0 / 31, kDoubleExact);    // at 100, 105, ..., 150
  EXPECT_NEAR(area_under_pck(std::vector<double>{100.5}), 10.0 / 31, kDoubleExact);  // from 105 on
  EXPECT_NEAR(area_under_pck(std::vector<double>{0, 1000}), 0.5, kDoubleExact);
  EXPECT_TRUE(std::isnan(area_under_pck({})));
}

// Trunk, two left points, two right points 300 mm beside them.
const std::vector<float> kBody = {0, 0, 0, 150, 0, 0, 150, 200, 0, -150, 0, 0, -150, 200, 0};
const SidePairs kLimbs = {{1, 3}, {2, 4}};

std::vector<float> with_points(std::vector<float> points, std::vector<std::pair<int, int>> copies) {
  const std::vector<float> from = points;
  for (const auto& [to, source] : copies) {
    for (int k = 0; k < 3; ++k) points[3 * to + k] = from[3 * source + k];
  }
  return points;
}

TEST(PoseMetrics, ExchangedLimbsAreSeen) {
  const std::vector<float> exchanged = with_points(kBody, {{1, 3}, {2, 4}, {3, 1}, {4, 2}});
  EXPECT_TRUE(sides_exchanged(exchanged, kBody, kLimbs));
  EXPECT_FALSE(sides_exchanged(kBody, kBody, kLimbs));
  // Exchanged back by hand: the pairs the other way round change nothing.
  EXPECT_TRUE(sides_exchanged(exchanged, kBody, {{3, 1}, {4, 2}}));
  EXPECT_FALSE(sides_exchanged(exchanged, kBody, {}));
}

TEST(PoseMetrics, AShiftOfEverythingIsNoExchange) {
  std::vector<float> shifted = with_points(kBody, {{1, 3}, {2, 4}, {3, 1}, {4, 2}});
  for (size_t i = 0; i < shifted.size(); i += 3) shifted[i] += 5000;
  EXPECT_TRUE(sides_exchanged(shifted, kBody, kLimbs));
  shifted = kBody;
  for (size_t i = 0; i < shifted.size(); i += 3) shifted[i] += 5000;
  EXPECT_FALSE(sides_exchanged(shifted, kBody, kLimbs));
}

TEST(PoseMetrics, TheErrorMustHalve) {
  // Both sides off by `move` towards the other: the named error is `move`, the exchanged one 300 - move. Halved when
  // 300 - move <= move / 2: from 200 mm on.
  const auto moved = [](float move) {
    std::vector<float> points = kBody;
    for (int k : {1, 2}) points[3 * k] -= move;
    for (int k : {3, 4}) points[3 * k] += move;
    return points;
  };
  EXPECT_FALSE(sides_exchanged(moved(199), kBody, kLimbs));
  EXPECT_TRUE(sides_exchanged(moved(201), kBody, kLimbs));
}

TEST(PoseMetrics, LimbsSideBySideAreNotExchanged) {
  // 40 mm apart and exchanged: the error of 40 mm is below kExchangeMm.
  std::vector<float> near = kBody;
  for (int k : {1, 2}) near[3 * k] = 20;
  for (int k : {3, 4}) near[3 * k] = -20;
  EXPECT_FALSE(sides_exchanged(with_points(near, {{1, 3}, {2, 4}, {3, 1}, {4, 2}}), near, kLimbs));
}

TEST(PoseMetrics, AnArmInTheTrunk) {
  // Pelvis, neck 500 mm above, a wrist beside the middle.
  const auto body = [](float wrist_mm, float height_mm = -250) {
    return std::vector<float>{0, 0, 3000, 0, -500, 3000, wrist_mm, height_mm, 3000};
  };
  const std::vector<int> wrist = {2};
  EXPECT_TRUE(limb_inside_trunk(body(89), body(161), 0, 1, wrist));
  EXPECT_FALSE(limb_inside_trunk(body(91), body(161), 0, 1, wrist));       // beside the trunk
  EXPECT_FALSE(limb_inside_trunk(body(89), body(159), 0, 1, wrist));       // the true one is close, too
  EXPECT_FALSE(limb_inside_trunk(body(0, -600), body(400), 0, 1, wrist));  // 100 mm above the neck
  EXPECT_TRUE(limb_inside_trunk(body(0, -580), body(400), 0, 1, wrist));
  EXPECT_FALSE(limb_inside_trunk(body(0), body(400), 0, 1, {}));
}

TEST(PoseMetrics, LimitsReachOneDegreeInwardsAndEndlesslyOutwards) {
  EXPECT_TRUE(at_limit(-150, -150, 2));
  EXPECT_TRUE(at_limit(-149, -150, 2));
  EXPECT_TRUE(at_limit(-170, -150, 2));
  EXPECT_TRUE(at_limit(1, -150, 2));
  EXPECT_TRUE(at_limit(9, -150, 2));
  EXPECT_FALSE(at_limit(-148.9, -150, 2));
  EXPECT_FALSE(at_limit(0.9, -150, 2));
}

}  // namespace
}  // namespace livecap
