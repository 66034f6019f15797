#include "base/median.h"

#include <gtest/gtest.h>

namespace livecap {
namespace {

TEST(Median, IsTheLargerOfTwoInTheMiddle) {
  EXPECT_EQ(median(std::vector<double>{5, 1, 3}), 3);
  EXPECT_EQ(median(std::vector<int>{4, 1, 3, 2}), 3);
  EXPECT_EQ(median(std::vector<float>{}), 0);
}

}  // namespace
}  // namespace livecap
