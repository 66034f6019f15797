#include "surface/hanging_cloth.h"

#include <gtest/gtest.h>

#include <map>

#include "livecap/error.h"

namespace livecap {
namespace {

constexpr int kRoot = 0, kHip = 1, kKnee = 2, kNeck = 3, kOtherHip = 4;

// One vertex per row of weights.
Actor actor_with(const std::vector<std::array<std::pair<int, float>, 4>>& rows, const std::vector<float>& rigidity) {
  Actor actor;
  actor.skeleton.bones = {{"root", -1, {0, 0, 0}},
                          {"left_hip", 0, {0, 0, 0}},
                          {"left_knee", 1, {0, 0, 0}},
                          {"neck", 0, {0, 0, 0}},
                          {"right_hip", 0, {0, 0, 0}}};
  for (const auto& row : rows) {
    for (const auto& [bone, weight] : row) {
      actor.skin.bones.push_back(bone);
      actor.skin.weights.push_back(weight);
    }
  }
  actor.mesh.positions.assign(3 * rows.size(), 0.0f);
  actor.rigidity = rigidity;
  return actor;
}

std::map<int, float> weights_of(const SkinWeights& skin, int vertex) {
  std::map<int, float> out;
  for (int k = 4 * vertex; k < 4 * vertex + 4; ++k) {
    if (skin.weights[k] == 0) {
      EXPECT_EQ(skin.bones[k], 0) << "unused slots name bone 0";
    } else {
      EXPECT_TRUE(out.emplace(skin.bones[k], skin.weights[k]).second) << "a bone twice";
    }
    if (k > 4 * vertex) EXPECT_LE(skin.weights[k], skin.weights[k - 1]) << "strongest first";
  }
  return out;
}

TEST(HangingCloth, LegsGiveTheirShareToTheBoneTheyHangFrom) {
  // L = 1 keeps 0.4; L = 0.5 keeps 0.4 / (0.4 + 0.6 * 0.5) = 4/7 of itself.
  const Actor actor = actor_with({{{{kHip, 0.75f}, {kKnee, 0.25f}, {0, 0}, {0, 0}}},
                                  {{{kRoot, 0.5f}, {kOtherHip, 0.5f}, {0, 0}, {0, 0}}},
                                  {{{kNeck, 0.6f}, {kRoot, 0.4f}, {0, 0}, {0, 0}}}},
                                 {1, 1, 1});
  const SkinWeights skin = hanging_cloth_weights(actor, 0.4f);
  const auto hem = weights_of(skin, 0), middle = weights_of(skin, 1), waist = weights_of(skin, 2);
  ASSERT_EQ(hem.size(), 3u);
  EXPECT_NEAR(hem.at(kRoot), 0.6f, 1e-6f);
  EXPECT_NEAR(hem.at(kHip), 0.3f, 1e-6f);
  EXPECT_NEAR(hem.at(kKnee), 0.1f, 1e-6f);
  ASSERT_EQ(middle.size(), 2u);
  EXPECT_NEAR(middle.at(kRoot), 1 - 2.0f / 7, 1e-6f);
  EXPECT_NEAR(middle.at(kOtherHip), 2.0f / 7, 1e-6f);
  EXPECT_EQ(waist, (std::map<int, float>{{kNeck, 0.6f}, {kRoot, 0.4f}}));
}

TEST(HangingCloth, FiveInfluencesBecomeTheFourStrongest) {
  const Actor actor = actor_with({{{{kHip, 0.4f}, {kNeck, 0.3f}, {kKnee, 0.2f}, {kOtherHip, 0.1f}}}}, {1});
  const auto weights = weights_of(hanging_cloth_weights(actor, 0.5f), 0);
  // L = 0.7 keeps 0.5 / 0.85 of itself; the weakest (right hip, 0.1 / 1.7) goes, the others sum to one.
  const float left = 1 - 0.1f / 1.7f;
  ASSERT_EQ(weights.size(), 4u);
  EXPECT_EQ(weights.count(kOtherHip), 0u);
  EXPECT_NEAR(weights.at(kNeck), 0.3f / left, 1e-6f);
  EXPECT_NEAR(weights.at(kHip), 0.4f / 1.7f / left, 1e-6f);
  EXPECT_NEAR(weights.at(kKnee), 0.2f / 1.7f / left, 1e-6f);
  EXPECT_NEAR(weights.at(kRoot), (0.7f - 0.7f / 1.7f) / left, 1e-6f);
}

TEST(HangingCloth, OtherMaterialAndAShareOfOneChangeNothing) {
  const Actor actor =
      actor_with({{{{kHip, 1}, {0, 0}, {0, 0}, {0, 0}}}, {{{kHip, 0.5f}, {kKnee, 0.5f}, {0, 0}, {0, 0}}}}, {2.5f, 50});
  const SkinWeights trousers = hanging_cloth_weights(actor, 0.4f);
  EXPECT_EQ(trousers.bones, actor.skin.bones);
  EXPECT_EQ(trousers.weights, actor.skin.weights);
  Actor skirt = actor;
  skirt.rigidity = {1, 1};
  EXPECT_EQ(hanging_cloth_weights(skirt, 1).weights, actor.skin.weights);
  EXPECT_NE(hanging_cloth_weights(skirt, 0.9f).weights, actor.skin.weights);
}

TEST(HangingCloth, RefusesSharesOutsideZeroToOne) {
  const Actor actor = actor_with({{{{kHip, 1}, {0, 0}, {0, 0}, {0, 0}}}}, {1});
  for (const float share : {0.0f, -0.1f, 1.01f, std::nanf("")}) {
    EXPECT_THROW(hanging_cloth_weights(actor, share), ConfigError) << share;
  }
}

}  // namespace
}  // namespace livecap
