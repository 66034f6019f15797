#include "export/frame_times.h"

#include <gtest/gtest.h>

#include <limits>

namespace livecap {
namespace {

TEST(FrameTimes, RoundedStampsOfAnEvenRateAreNone) {
  EXPECT_TRUE(uneven_times_s({}, 30).empty());
  EXPECT_TRUE(uneven_times_s(std::vector<double>{500, 533, 567, 600}, 30).empty()) << "it need not begin at 0";
}

TEST(FrameTimes, AGapIsKept) {
  const std::vector<double> times = uneven_times_s(std::vector<double>{500, 533, 633, 667}, 30);
  ASSERT_EQ(times.size(), 4u);
  EXPECT_DOUBLE_EQ(times[0], 0);
  EXPECT_DOUBLE_EQ(times[2], 0.133);
}

TEST(FrameTimes, WhatTellsNoTimeIsEven) {
  EXPECT_TRUE(uneven_times_s(std::vector<double>{0, 33, 33, 400}, 30).empty());
  EXPECT_TRUE(uneven_times_s(std::vector<double>{0, std::numeric_limits<double>::quiet_NaN(), 900}, 30).empty());
}

}  // namespace
}  // namespace livecap
