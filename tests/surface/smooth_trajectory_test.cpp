#include "surface/smooth_trajectory.h"

#include <gtest/gtest.h>

#include "livecap/error.h"

namespace livecap {
namespace {

TEST(SmoothTrajectory, ImpulseSpreadsAndEndsRepeat) {
  std::vector<std::vector<float>> frames = {{0, 1}, {0, 1}, {1, 1}, {0, 1}, {2, 1}};
  smooth_trajectory(frames);
  const float expected[] = {0.0f, 0.15f, 0.7f, 0.45f, 1.7f};
  for (size_t t = 0; t < frames.size(); ++t) {
    EXPECT_FLOAT_EQ(frames[t][0], expected[t]) << t;
    EXPECT_FLOAT_EQ(frames[t][1], 1.0f) << t;
  }
}

TEST(SmoothTrajectory, OneFrameAndNoneStay) {
  std::vector<std::vector<float>> one = {{3, 4}};
  smooth_trajectory(one);
  EXPECT_FLOAT_EQ(one[0][0], 3.0f);
  std::vector<std::vector<float>> none;
  EXPECT_NO_THROW(smooth_trajectory(none));
  std::vector<std::vector<float>> uneven = {{1, 2}, {1}};
  EXPECT_THROW(smooth_trajectory(uneven), LogicError);
}

}  // namespace
}  // namespace livecap
