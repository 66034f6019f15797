#include "geometry/shortest_turn.h"

#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(ShortestTurn, IsEigens) {
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d from = 3 * Eigen::Vector3d::Random(), to = 0.2 * Eigen::Vector3d::Random();
    EXPECT_LT(shortest_turn(from, to).angularDistance(Eigen::Quaterniond::FromTwoVectors(from, to)), test::kTurnRad);
    EXPECT_LT((shortest_turn(from, to) * from.normalized() - to.normalized()).norm(), test::kTurn);
  }
}

TEST(ShortestTurn, OfOneDirectionIsNone) {
  const Eigen::Vector3d v(1, -2, 0.5);
  EXPECT_LT(shortest_turn(v, 2 * v).angularDistance(Eigen::Quaterniond::Identity()), test::kTurnRad);
}

TEST(ShortestTurn, OfOppositeDirectionsIsHalf) {
  for (const double off : {0.0, 1e-9, 1e-7, 1e-5}) {
    for (const Eigen::Vector3d& v : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, -2, 0.5)}) {
      const Eigen::Vector3d to = -v + off * v.unitOrthogonal();
      const Eigen::Quaterniond turn = shortest_turn(v, to);
      EXPECT_NEAR(turn.norm(), 1, test::kTurn) << off;
      EXPECT_LT((turn * v.normalized() - to.normalized()).norm(), test::kNearOpposite) << off;
    }
  }
}

}  // namespace
}  // namespace livecap
