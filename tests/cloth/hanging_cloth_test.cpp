#include "cloth/hanging_cloth.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>

#include "cloth/scene.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr int kRoot = 0, kHip = 1, kKnee = 2, kNeck = 3, kOtherHip = 4, kHanging = 5;

// One vertex per row of weights. They belong to no triangle.
Actor actor_with(const std::vector<std::array<std::pair<int, float>, 4>>& rows, const std::vector<float>& rigidity) {
  Actor actor;
  actor.skeleton.bones = {{"root", -1, {0, 0, 0}},
                          {"left_hip", 0, {100, -50, 0}},
                          {"left_knee", 1, {0, 0, 0}},
                          {"neck", 0, {0, 0, 0}},
                          {"right_hip", 0, {-100, -50, 0}}};
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

// Stage I has no bone for what hangs: the pelvis takes it, once. L = 1 keeps 0.4; L = 0.5 keeps 0.4 / (0.4 + 0.6 * 0.5)
// = 4/7 of itself.
TEST(HangingCloth, WithoutTheHangingBoneTheHipsBoneTakesTheShare) {
  const Actor actor = actor_with({{{{kHip, 0.75f}, {kKnee, 0.25f}, {0, 0}, {0, 0}}},
                                  {{{kRoot, 0.5f}, {kOtherHip, 0.5f}, {0, 0}, {0, 0}}},
                                  {{{kHip, 1.0f}, {0, 0}, {0, 0}, {0, 0}}}},
                                 {1, 1, 2});
  const SkinWeights skin = hanging_weights(actor, {.taut_leg_share = 0.4f, .loose_leg_share = 0.4f});
  const auto hem = weights_of(skin, 0), middle = weights_of(skin, 1), trousers = weights_of(skin, 2);
  ASSERT_EQ(hem.size(), 3u);
  EXPECT_NEAR(hem.at(kRoot), 0.6f, 1e-6f);
  EXPECT_NEAR(hem.at(kHip), 0.3f, 1e-6f);
  ASSERT_EQ(middle.size(), 2u);
  EXPECT_NEAR(middle.at(kRoot), 5.0f / 7, 1e-6f);
  EXPECT_NEAR(middle.at(kOtherHip), 2.0f / 7, 1e-6f);
  EXPECT_EQ(trousers, (std::map<int, float>{{kHip, 1.0f}}));
  EXPECT_EQ(hanging_weights(actor, {.taut_leg_share = 1.0f, .loose_leg_share = 1.0f}).weights, actor.skin.weights);
  EXPECT_THROW(hanging_weights(actor, {.taut_leg_share = 0.0f}), ConfigError);
}

// What stands away from the legs follows them less than what lies on them.
TEST(HangingCloth, TautClothFollowsTheLegsLessInStageOne) {
  const auto on_legs = [](double depth) {
    const Actor actor = test::folded_skirt(depth, 12);
    const SkinWeights skin = hanging_weights(actor, {.taut_leg_share = 0.2f, .loose_leg_share = 0.6f});
    float legs = 0;
    for (int k = 0; k < 4; ++k)
      if (skin.bones[k] != 0) legs += skin.weights[k];
    return legs;
  };
  const auto kept = [](float c) { return c / (c + (1 - c) * 0.5f) * 0.5f; };  // of weights that sum to 0.5
  EXPECT_NEAR(on_legs(0), kept(0.2f), 1e-6f);
  EXPECT_NEAR(on_legs(0.3), kept(0.6f), 1e-6f);
}

// A guessed weight of 0.5 on the legs is worth 0.25.
TEST(HangingCloth, FollowsTheLegsLessInStageOneWhereWeightsAreGuessed) {
  Actor actor = actor_with({{{{kRoot, 0.5f}, {kOtherHip, 0.3f}, {kHip, 0.2f}, {0, 0}}},
                            {{{kRoot, 0.5f}, {kOtherHip, 0.5f}, {0, 0}, {0, 0}}}},
                           {1, 2});
  EXPECT_EQ(trusted_leg_weights(actor, {}), leg_weights(actor));
  actor.guessed_weights = true;
  EXPECT_EQ(trusted_leg_weights(actor, {}), (std::vector<float>{0.25f, 0.5f}));
  const auto skirt = weights_of(hanging_weights(actor, {.taut_leg_share = 1, .loose_leg_share = 1}), 0);
  ASSERT_EQ(skirt.size(), 3u);
  EXPECT_NEAR(skirt.at(kRoot), 0.75f, 1e-6f);
  EXPECT_NEAR(skirt.at(kOtherHip), 0.15f, 1e-6f);
  const HangingClothOptions as_it_is{.taut_leg_share = 1, .loose_leg_share = 1, .guessed_power = 1};
  EXPECT_EQ(hanging_weights(actor, as_it_is).weights, actor.skin.weights);
}

// In stage II, whoever painted them: of 0.5 on the legs 0.125 is left by the third power, all of 1.
TEST(HangingCloth, IsCarriedByTheLegsOnlyWhereItLiesOnThem) {
  Actor actor = actor_with({{{{kRoot, 0.5f}, {kOtherHip, 0.3f}, {kHip, 0.2f}, {0, 0}}},
                            {{{kHip, 0.75f}, {kKnee, 0.25f}, {0, 0}, {0, 0}}},
                            {{{kRoot, 0.5f}, {kOtherHip, 0.5f}, {0, 0}, {0, 0}}}},
                           {1, 1, 2});
  for (const bool guessed : {false, true}) {
    actor.guessed_weights = guessed;
    const SkinWeights skin = HangingCloth(actor, {.carried_power = 3}).weights();
    const auto middle = weights_of(skin, 0);
    ASSERT_EQ(middle.size(), 4u);
    EXPECT_NEAR(middle.at(kRoot), 0.5f, 1e-6f);
    EXPECT_NEAR(middle.at(kHanging), 0.375f, 1e-6f);
    EXPECT_NEAR(middle.at(kOtherHip), 0.075f, 1e-6f);
    EXPECT_NEAR(middle.at(kHip), 0.05f, 1e-6f);
    EXPECT_EQ(weights_of(skin, 1), weights_of(actor.skin, 1)) << "on the leg";
    EXPECT_EQ(weights_of(skin, 2), weights_of(actor.skin, 2)) << "trousers";
  }
}

TEST(HangingCloth, FiveInfluencesBecomeTheFourStrongest) {
  const Actor actor = actor_with({{{{kHip, 0.4f}, {kNeck, 0.3f}, {kKnee, 0.2f}, {kOtherHip, 0.1f}}}}, {1});
  const auto kept = weights_of(HangingCloth(actor, {.carried_power = 2}).weights(), 0);
  // L = 0.7 keeps 0.7 of itself; the weakest (right hip, 0.07) goes, the others sum to one.
  const float left = 0.93f;
  ASSERT_EQ(kept.size(), 4u);
  EXPECT_EQ(kept.count(kOtherHip), 0u);
  EXPECT_NEAR(kept.at(kNeck), 0.3f / left, 1e-6f);
  EXPECT_NEAR(kept.at(kHip), 0.28f / left, 1e-6f);
  EXPECT_NEAR(kept.at(kKnee), 0.14f / left, 1e-6f);
  EXPECT_NEAR(kept.at(kHanging), 0.21f / left, 1e-6f);
}

TEST(HangingCloth, OtherMaterialAndAPowerOfOneChangeNothing) {
  const Actor actor =
      actor_with({{{{kHip, 1}, {0, 0}, {0, 0}, {0, 0}}}, {{{kHip, 0.5f}, {kRoot, 0.5f}, {0, 0}, {0, 0}}}}, {2.5f, 50});
  const SkinWeights trousers = HangingCloth(actor, {}).weights();
  EXPECT_EQ(trousers.bones, actor.skin.bones);
  EXPECT_EQ(trousers.weights, actor.skin.weights);
  Actor skirt = actor;
  skirt.rigidity[0] = skirt.rigidity[1] = 1;
  EXPECT_EQ(HangingCloth(skirt, {.carried_power = 1}).weights().weights, actor.skin.weights);
  EXPECT_NE(HangingCloth(skirt, {.carried_power = 1.1f}).weights().weights, actor.skin.weights);
}

// Rotation and translation of bone b from its dual quaternion, written out: t = 2 dual conj(real).
Eigen::Isometry3d motion_of(const std::vector<float>& quats, int b) {
  const float* q = quats.data() + 8 * b;
  const Eigen::Quaterniond real(q[0], q[1], q[2], q[3]), dual(q[4], q[5], q[6], q[7]);
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = real.toRotationMatrix();
  out.translation() = 2 * (dual * real.conjugate()).vec();
  return out;
}

// The body upright in the camera frame (y down), then tilted by `tilt` rad about the camera's x axis.
PosedSkeleton tilted(const Actor& actor, double tilt) {
  Pose pose;
  pose.root_rotation =
      (Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  pose.root_translation_mm = {30, -20, 3000};
  pose.angles_rad = Eigen::VectorXd::Zero(0);
  return forward_kinematics(actor.skeleton, pose);
}

TEST(HangingCloth, TheHangingBoneTurnsTowardsTheVerticalAboutTheHips) {
  const Actor actor = actor_with({{{{kHip, 1}, {0, 0}, {0, 0}, {0, 0}}}}, {1});
  const Eigen::Vector3d hips(0, -50, 0), hem(0, -450, 0);  // rest frame
  for (const double tilt : {0.4, -0.2}) {
    const PosedSkeleton posed = tilted(actor, tilt);
    for (const float share : {0.0f, 0.5f, 1.0f}) {
      const auto quats = HangingCloth(actor, {.gravity_share = share}).dual_quats(posed, -Eigen::Vector3d::UnitY());
      ASSERT_EQ(quats.size(), 8u * 6);
      const Eigen::Isometry3d root = motion_of(quats, kRoot), hanging = motion_of(quats, kHanging);
      EXPECT_LT((root.matrix() - posed.camera_from_rest[kRoot].matrix()).norm(), 1e-2);
      EXPECT_LT((hanging * hips - root * hips).norm(), 1e-2) << "the hips stay";
      const Eigen::Vector3d line = hanging * hem - hanging * hips;
      EXPECT_NEAR(std::atan2(line.z(), line.y()), tilt * (1 - share * std::cos(tilt)), 1e-4);
      EXPECT_NEAR(line.norm(), 400, 1e-2);
      EXPECT_NEAR(line.x(), 0, 1e-2);
    }
  }
}

// Before a camera that looks down by 0.15 rad a body that stands upright is tilted in the picture, and its cloth as
// well.
TEST(HangingCloth, TheVerticalIsNotThePictures) {
  const Actor actor = actor_with({{{{kHip, 1}, {0, 0}, {0, 0}, {0, 0}}}}, {1});
  const Eigen::Vector3d hips(0, -50, 0), hem(0, -450, 0);
  const Eigen::Vector3d up(0, -std::cos(0.15), -std::sin(0.15));
  const auto quats = HangingCloth(actor, {.gravity_share = 1}).dual_quats(tilted(actor, 0), up);
  const Eigen::Vector3d line = motion_of(quats, kHanging) * hem - motion_of(quats, kHanging) * hips;
  EXPECT_NEAR(std::atan2(line.z(), line.y()), 0.15 * std::cos(0.15), 1e-4);
}

TEST(HangingCloth, ABodyUpsideDownIsLeftAsItIs) {
  const Actor actor = actor_with({{{{kHip, 1}, {0, 0}, {0, 0}, {0, 0}}}}, {1});
  for (const double tilt : {1.7, 3.0, M_PI}) {
    const auto quats = HangingCloth(actor, {}).dual_quats(tilted(actor, tilt), -Eigen::Vector3d::UnitY());
    EXPECT_EQ(std::vector<float>(quats.begin() + 8 * kHanging, quats.end()),
              std::vector<float>(quats.begin(), quats.begin() + 8));
  }
}

TEST(HangingCloth, OptionsAreChecked) {
  const Actor actor = actor_with({{{{kHip, 1}, {0, 0}, {0, 0}, {0, 0}}}}, {1});
  for (const float share : {0.0f, -0.1f, 1.01f, std::nanf("")}) {
    EXPECT_THROW(HangingCloth(actor, {.taut_leg_share = share}), ConfigError) << share;
    EXPECT_THROW(HangingCloth(actor, {.loose_leg_share = share}), ConfigError) << share;
  }
  for (const float power : {0.5f, std::nanf(""), INFINITY}) {
    EXPECT_THROW(HangingCloth(actor, {.guessed_power = power}), ConfigError) << power;
    EXPECT_THROW(HangingCloth(actor, {.carried_power = power}), ConfigError) << power;
  }
  for (const float share : {-0.1f, 1.01f, std::nanf("")}) {
    EXPECT_THROW(HangingCloth(actor, {.gravity_share = share}), ConfigError) << share;
  }
  for (const auto& [taut, loose] : {std::pair{-0.1f, 0.1f}, {0.1f, 0.1f}, {std::nanf(""), 0.1f}, {0.1f, INFINITY}})
    EXPECT_THROW(HangingCloth(actor, {.taut = taut, .loose = loose}), ConfigError) << taut << " " << loose;
}

}  // namespace
}  // namespace livecap
