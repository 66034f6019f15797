// Targets of the keypoints: how detections that lie far from the body are doubted.
#include "pose/targets.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/tolerances.h"

namespace livecap {
namespace {

// The weight of a robust cost rho(r) = s^2 log(1 + r^2 / s^2) is rho'(r) / 2r, here by central differences.
TEST(Targets, FarDetectionsAreDoubtedAsACauchyCostDoes) {
  constexpr double kScale = 60, kWeight = 7, kStep = 1e-4;
  const auto rho = [](double r) { return kScale * kScale * std::log1p(r * r / (kScale * kScale)); };
  for (double r : {0.5, 20.0, 60.0, 300.0}) {
    KeypointTargets targets{};
    std::array<Eigen::Vector3d, kKeypointCount> positions;
    positions.fill(Eigen::Vector3d(100, 50, 3000));
    // Two that outweigh the rest say where the body is.
    for (int k : {kLeftHip, kRightHip}) targets[k].weight_3d = 1e9;
    targets[kLeftKnee].weight_3d = targets[kRightKnee].weight_3d = kWeight;
    targets[kLeftKnee].detection_mm = Eigen::Vector3d(2, -1, 2) / 3 * r;
    doubt_far_detections(targets, positions, kScale);
    const double slope = (rho(r + kStep) - rho(r - kStep)) / (2 * kStep);
    EXPECT_NEAR(targets[kLeftKnee].weight_3d, kWeight * slope / (2 * r), kWeight * test::kFiniteDifference) << r;
    EXPECT_NEAR(targets[kRightKnee].weight_3d, kWeight, kWeight * test::kFiniteDifference);
    EXPECT_EQ(targets[kLeftAnkle].weight_3d, 0);
  }
}

TEST(Targets, DoubtedCostIsTheSquareNearByAndTheScalesFarAway) {
  EXPECT_EQ(doubted_cost(49, 0), 49);
  EXPECT_NEAR(doubted_cost(1e-4, 60), 1e-4, 1e-4 * test::kHandComputed);
  EXPECT_NEAR(doubted_cost(3600, 60), 1800, 1800 * test::kHandComputed);
  EXPECT_NEAR(doubted_cost(1e12, 60), 3600, 3600 * test::kHandComputed);
}

}  // namespace
}  // namespace livecap
