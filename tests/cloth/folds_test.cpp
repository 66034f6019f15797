// How much of a garment lies in folds.
#include "cloth/folds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cloth/hanging_cloth.h"
#include "cloth/scene.h"
#include "support/builtin_actor.h"

namespace livecap {
namespace {

TEST(Folds, AConeHasNone) {
  EXPECT_NEAR(share_in_folds(test::skirt_actor()), 0, 1e-4);
  EXPECT_NEAR(share_in_folds(test::folded_skirt(0, 0)), 0, 1e-4);
}

// Around it is the integral of sqrt(r^2 + r'^2). The hull of six deep folds goes from crest to crest and is a little
// longer than the hexagon of the crests' tips.
TEST(Folds, MoreThanTheHullNeeds) {
  for (const double depth : {0.15, 0.2, 0.3}) {
    constexpr int kFolds = 6, kSteps = 100000;
    double around = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double t = 2 * M_PI * (k + 0.5) / kSteps;
      around += std::hypot(1 + depth * std::cos(kFolds * t), depth * kFolds * std::sin(kFolds * t)) * 2 * M_PI / kSteps;
    }
    const double hexagon = (1 + depth) * 2 * kFolds * std::sin(M_PI / kFolds);
    const double share = share_in_folds(test::folded_skirt(depth, kFolds));
    EXPECT_LT(share, around / hexagon - 1) << depth;
    const double least = around / (2 * M_PI * (1 + depth)) - 1;  // the hull is within the circle of the tips
    if (depth > 0.15) EXPECT_GT(least, 0);
    EXPECT_GT(share, least) << depth;
  }
  EXPECT_GT(share_in_folds(test::folded_skirt(0.15, 6)), 2 * share_in_folds(test::folded_skirt(0.1, 6)));
}

TEST(Folds, WhatIsOpenOrDoesNotHangHasNone) {
  EXPECT_GT(share_in_folds(test::folded_skirt(0.15, 24)), 0.5);
  EXPECT_EQ(share_in_folds(test::folded_skirt(0.15, 24, true)), 0);
  Actor trousers = test::folded_skirt(0.15, 6);
  std::fill(trousers.rigidity.begin(), trousers.rigidity.end(), 2.0f);
  EXPECT_EQ(share_in_folds(trousers), 0);
  Actor cape = test::folded_skirt(0.15, 6);  // hangs from shoulders
  for (size_t k = 0; k < cape.skin.bones.size(); k += 4) cape.skin.bones[k] = 0;
  EXPECT_EQ(share_in_folds(cape), 0);
  EXPECT_EQ(share_in_folds(Actor{}), 0);
}

TEST(Folds, MakeClothLoose) {
  const Actor skirt = test::folded_skirt(0.1, 6);
  const float share = float(share_in_folds(skirt));
  const auto loose_by = [&](float taut, float loose) { return looseness(skirt, {.taut = taut, .loose = loose}); };
  EXPECT_EQ(loose_by(1.1f * share, 1.2f * share), 0);
  EXPECT_EQ(loose_by(0.5f * share, 0.9f * share), 1);
  EXPECT_NEAR(loose_by(0.4f * share, 1.2f * share), 0.75, 1e-4);
}

// Its lining and its lid are shorter around than what is seen of it.
TEST(Folds, TheBuiltInSkirtIsNearlyTaut) {
  const double share = share_in_folds(test::builtin_actor("skirt"));
  EXPECT_GT(share, 0.01);
  EXPECT_LT(share, 0.03);
  EXPECT_EQ(share_in_folds(test::builtin_actor("trousers")), 0);
}

}  // namespace
}  // namespace livecap
