#include "geometry/disjoint_sets.h"

#include <gtest/gtest.h>

namespace livecap {
namespace {

TEST(DisjointSets, GrowByPairs) {
  DisjointSets sets(6);
  EXPECT_EQ(sets.find(3), 3);
  EXPECT_TRUE(sets.join(0, 1));
  EXPECT_TRUE(sets.join(4, 5));
  EXPECT_FALSE(sets.join(1, 0));
  EXPECT_EQ(sets.find(0), 1) << "b's member stands for both";
  EXPECT_NE(sets.find(0), sets.find(4));
  EXPECT_TRUE(sets.join(0, 4));
  for (int i : {0, 1, 4, 5}) EXPECT_EQ(sets.find(i), 5) << i;
  EXPECT_EQ(sets.find(2), 2);
}

}  // namespace
}  // namespace livecap
