#include "geometry/segment.h"

#include <gtest/gtest.h>

namespace livecap {
namespace {

using Vector3 = Eigen::Vector3d;

TEST(Segment, TheNearestPointIsBetweenTheEnds) {
  const Vector3 a(1, 2, 3), b(1, 2, 7);
  EXPECT_EQ(segment_parameter({4, -5, 4}, a, b), 0.25);
  EXPECT_EQ(segment_parameter({0, 0, -9}, a, b), 0);
  EXPECT_EQ(segment_parameter({0, 0, 99}, a, b), 1);
  EXPECT_EQ(segment_parameter({0, 0, 99}, a, a), 0) << "no longer than a point";
}

}  // namespace
}  // namespace livecap
