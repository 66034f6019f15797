#include "pose/leg_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "livecap/error.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kBend = 0.3;  // rad that thighs point forwards; knees twice that
constexpr int kLong = 600;     // frames after which the prior hardly counts

struct BiasScene {
  Actor actor = test::make_test_actor(0.7);
  Camera camera = test::portrait_camera();

  Pose standing(double facing_rad, double bend_rad) const {
    return test::with_bent_legs(actor, test::standing_pose(actor, facing_rad), -bend_rad, 2 * bend_rad);
  }
  KeypointDetections seen(const Pose& pose) const { return test::exact_detections(actor, camera, pose).keypoints; }
};

Eigen::Vector3d limb(const KeypointDetections& k, int from, int to) {
  return {k[to].x_mm - k[from].x_mm, k[to].y_mm - k[from].y_mm, k[to].z_mm - k[from].z_mm};
}

double depth(const KeypointDetections& k, int from, int to) {
  return limb(k, from, to).z() / limb(k, from, to).norm();
}

TEST(LegBias, WhatTheNetworkMissesIsAdded) {
  const BiasScene scene;
  const Pose bent = scene.standing(0, kBend);
  const KeypointDetections straight = scene.seen(scene.standing(0, 0)), wanted = scene.seen(bent);
  LegBias bias({});
  for (int i = 0; i < kLong; ++i) bias.learn(scene.actor, straight, bent);
  const KeypointDetections corrected = bias.corrected(straight, bent);
  for (auto [from, to] :
       {std::pair{kLeftHip, kLeftKnee}, {kRightHip, kRightKnee}, {kLeftKnee, kLeftAnkle}, {kRightKnee, kRightAnkle}}) {
    const double missing = depth(wanted, from, to) - depth(straight, from, to);
    EXPECT_GT(std::abs(missing), 0.2);
    const double got = depth(corrected, from, to) - depth(straight, from, to);
    EXPECT_GT(got / missing, 0.7) << "of " << missing;
    EXPECT_LT(got / missing, 1.0);
    EXPECT_NEAR(limb(corrected, from, to).norm(), limb(straight, from, to).norm(), test::kMillimetreFloat);
  }
  // Feet move along; what is no leg, and the picture, stay.
  EXPECT_LT((limb(corrected, kLeftAnkle, kLeftToe) - limb(straight, kLeftAnkle, kLeftToe)).norm(),
            test::kMillimetreFloat);
  for (int k = 0; k < kKeypointCount; ++k) {
    EXPECT_EQ(corrected[k].x_px, straight[k].x_px);
    EXPECT_EQ(corrected[k].confidence, straight[k].confidence);
    if (k < kLeftKnee || k > kRightToe) EXPECT_EQ(corrected[k].z_mm, straight[k].z_mm) << k;
  }
}

// Learned from the front, it holds from behind, where legs reach away from the camera, and asks nothing from the side.
TEST(LegBias, TurnsWithThePerson) {
  const BiasScene scene;
  LegBias bias({});
  for (int i = 0; i < kLong; ++i) bias.learn(scene.actor, scene.seen(scene.standing(0, 0)), scene.standing(0, kBend));
  const auto added = [&](double facing_rad) {
    const KeypointDetections straight = scene.seen(scene.standing(facing_rad, 0));
    return depth(bias.corrected(straight, scene.standing(facing_rad, 0)), kLeftHip, kLeftKnee) -
           depth(straight, kLeftHip, kLeftKnee);
  };
  EXPECT_LT(added(0), -0.2);
  EXPECT_GT(added(std::numbers::pi), 0.2);
  EXPECT_NEAR(added(std::numbers::pi / 2), 0, test::kDirectionFloat);
  LegBias from_the_side({});
  for (int i = 0; i < kLong; ++i)
    from_the_side.learn(scene.actor, scene.seen(scene.standing(std::numbers::pi / 2, 0)),
                        scene.standing(std::numbers::pi / 2, kBend));
  const KeypointDetections straight = scene.seen(scene.standing(0, 0));
  EXPECT_NEAR(depth(from_the_side.corrected(straight, scene.standing(0, 0)), kLeftHip, kLeftKnee),
              depth(straight, kLeftHip, kLeftKnee), test::kDirectionFloat);
}

TEST(LegBias, FewFramesSayLittleAndAllCanBeForgotten) {
  const BiasScene scene;
  const Pose bent = scene.standing(0, kBend);
  const KeypointDetections straight = scene.seen(scene.standing(0, 0));
  const auto added = [&](const LegBias& bias) {
    return std::abs(depth(bias.corrected(straight, bent), kLeftHip, kLeftKnee) - depth(straight, kLeftHip, kLeftKnee));
  };
  LegBias bias({.memory = 60, .prior = 10});
  EXPECT_NEAR(added(bias), 0, test::kDirectionFloat);
  bias.learn(scene.actor, straight, bent);
  EXPECT_LT(added(bias), 0.04);
  for (int i = 0; i < kLong; ++i) bias.learn(scene.actor, straight, bent);
  EXPECT_GT(added(bias), 0.2);
  // Who is seen as they are later on soon has none.
  for (int i = 0; i < kLong; ++i) bias.learn(scene.actor, scene.seen(bent), bent);
  EXPECT_LT(added(bias), 0.02);
  for (int i = 0; i < kLong; ++i) bias.learn(scene.actor, straight, bent);
  bias.forget();
  EXPECT_NEAR(added(bias), 0, test::kDirectionFloat);
}

// Feet that are seen below knees that are guessed.
TEST(LegBias, ALimbIsAsGoodAsItsWorseEnd) {
  const BiasScene scene;
  const Pose bent = scene.standing(0, kBend);
  const KeypointDetections straight = scene.seen(scene.standing(0, 0));
  for (const int guessed : {kLeftHip, kLeftKnee, kLeftAnkle}) {
    KeypointDetections detected = straight;
    for (const int k : {guessed, guessed + 1}) detected[k].confidence = 0.1f;  // of both legs
    LegBias bias({});
    for (int i = 0; i < kLong; ++i) bias.learn(scene.actor, detected, bent);
    const KeypointDetections corrected = bias.corrected(straight, bent);
    const auto learned = [&](int from, int to) {
      return std::abs(depth(corrected, from, to) - depth(straight, from, to)) > 0.2;
    };
    EXPECT_EQ(learned(kLeftHip, kLeftKnee), guessed == kLeftAnkle) << guessed;
    EXPECT_EQ(learned(kLeftKnee, kLeftAnkle), guessed == kLeftHip) << guessed;
  }
}

TEST(LegBias, WhatWasNotSeenTellsNothing) {
  const BiasScene scene;
  const Pose bent = scene.standing(0, kBend);
  KeypointDetections hidden = scene.seen(scene.standing(0, 0)), undefined = hidden;
  for (int k = kLeftKnee; k <= kRightToe; ++k) {
    hidden[k].confidence = 0.1f;
    undefined[k].z_mm = std::numeric_limits<float>::quiet_NaN();
  }
  LegBias bias({});
  for (const KeypointDetections& detected : {hidden, undefined, KeypointDetections{}})
    for (int i = 0; i < kLong; ++i) bias.learn(scene.actor, detected, bent);
  const KeypointDetections straight = scene.seen(scene.standing(0, 0));
  EXPECT_NEAR(depth(bias.corrected(straight, bent), kLeftHip, kLeftKnee), depth(straight, kLeftHip, kLeftKnee),
              test::kDirectionFloat);
  EXPECT_THROW(LegBias({.memory = 0}), ConfigError);
  EXPECT_THROW(LegBias({.prior = std::nan("")}), ConfigError);
}

}  // namespace
}  // namespace livecap
