#include "pose/leg_exchange.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "support/pose_scene.h"

namespace livecap {
namespace {

constexpr double kRad = std::numbers::pi / 180;

// With left and right of these pairs exchanged; a pair is named by its left keypoint.
KeypointDetections exchanged(KeypointDetections k, std::initializer_list<int> lefts) {
  for (int left : lefts) std::swap(k[left], k[left + 1]);
  return k;
}

bool same(const KeypointDetections& a, const KeypointDetections& b) {
  for (int i = 0; i < kKeypointCount; ++i) {
    if (a[i].x_px != b[i].x_px || a[i].y_px != b[i].y_px || a[i].x_mm != b[i].x_mm || a[i].y_mm != b[i].y_mm ||
        a[i].z_mm != b[i].z_mm || a[i].confidence != b[i].confidence)
      return false;
  }
  return true;
}

bool holds(const std::vector<KeypointDetections>& alternatives, const KeypointDetections& wanted) {
  for (const KeypointDetections& alternative : alternatives) {
    if (same(alternative, wanted)) return true;
  }
  return false;
}

class LegExchange : public testing::Test {
 protected:
  // Every keypoint has its own confidence, so that it shows when one goes astray.
  KeypointDetections seen(const Pose& pose) const {
    KeypointDetections k = test::exact_detections(actor_, camera_, pose).keypoints;
    for (int i = 0; i < kKeypointCount; ++i) k[i].confidence = 0.5f + 0.02f * float(i);
    return k;
  }

  Actor actor_ = test::make_test_actor(0.7);
  Camera camera_ = test::portrait_camera();
};

TEST_F(LegExchange, WhatWasPredictedHasNoAlternative) {
  for (double facing_deg : {0, 40, 90, 140, 180, 220, 320}) {
    const Pose pose = test::standing_pose(actor_, facing_deg * kRad);
    EXPECT_TRUE(exchanged_legs(actor_, camera_, pose, seen(pose)).empty()) << facing_deg;
  }
}

TEST_F(LegExchange, FromTheKneesOrTheAnklesDownward) {
  const KeypointDetections k = seen(test::standing_pose(actor_, 0.3));
  EXPECT_TRUE(same(with_legs_exchanged(k, true), exchanged(k, {kLeftKnee, kLeftAnkle, kLeftToe})));
  EXPECT_TRUE(same(with_legs_exchanged(k, false), exchanged(k, {kLeftAnkle, kLeftToe})));
}

TEST_F(LegExchange, ExchangedFeetArePutBack) {
  for (double facing_deg : {0, 40, 140, 180, 220, 320}) {
    const Pose pose = test::standing_pose(actor_, facing_deg * kRad);
    const KeypointDetections truth = seen(pose);
    EXPECT_TRUE(holds(exchanged_legs(actor_, camera_, pose, exchanged(truth, {kLeftAnkle, kLeftToe})), truth))
        << facing_deg;
  }
}

TEST_F(LegExchange, ExchangedLegsArePutBack) {
  for (double facing_deg : {0, 40, 140, 180, 220, 320}) {
    const Pose pose = test::standing_pose(actor_, facing_deg * kRad);
    const KeypointDetections truth = seen(pose);
    EXPECT_TRUE(
        holds(exchanged_legs(actor_, camera_, pose, exchanged(truth, {kLeftKnee, kLeftAnkle, kLeftToe})), truth))
        << facing_deg;
  }
}

// With a foot far in front of the other knee, exchanging the knees too would be worse than the names as they are.
TEST_F(LegExchange, OnlyWhatIsNearerIsOffered) {
  Pose pose = test::standing_pose(actor_, 0);
  KeypointDetections truth = seen(pose);
  // Knees spread by 150 px, feet nearly together: only the feet can have been exchanged.
  KeypointDetections detected = truth;
  for (int dof = 0; dof < actor_.skeleton.n_dofs(); ++dof) {
    const std::string& name = actor_.skeleton.dofs[dof].name;
    if (name == "left_hip_z") pose.angles_rad[dof] = 0.3;
    if (name == "right_hip_z") pose.angles_rad[dof] = -0.3;
  }
  truth = seen(pose);
  for (int left : {kLeftAnkle, kLeftToe}) {
    const float middle = (truth[left].x_px + truth[left + 1].x_px) / 2;
    truth[left].x_px = middle + 5;
    truth[left + 1].x_px = middle - 5;
  }
  detected = exchanged(truth, {kLeftAnkle, kLeftToe});
  const auto alternatives = exchanged_legs(actor_, camera_, pose, detected);
  ASSERT_EQ(alternatives.size(), 1u);
  EXPECT_TRUE(same(alternatives[0], truth));
}

// Hips that lie across the picture by less than half of their distance: beyond 60 degrees.
TEST_F(LegExchange, SeenFromTheSideThereIsNone) {
  for (const auto& [facing_deg, any] : {std::pair{90, false}, std::pair{-90, false}, std::pair{62, false},
                                        std::pair{118, false}, std::pair{58, true}}) {
    const Pose pose = test::standing_pose(actor_, facing_deg * kRad);
    const KeypointDetections detected = exchanged(seen(pose), {kLeftKnee, kLeftAnkle, kLeftToe});
    EXPECT_EQ(!exchanged_legs(actor_, camera_, pose, detected).empty(), any) << facing_deg;
  }
}

TEST_F(LegExchange, WithoutAnchorsThereIsNone) {
  const Pose pose = test::standing_pose(actor_, 0);
  const KeypointDetections detected = exchanged(seen(pose), {kLeftKnee, kLeftAnkle, kLeftToe});
  const std::vector<int> legs = {kLeftKnee, kRightKnee, kLeftAnkle, kRightAnkle, kLeftToe, kRightToe};
  for (const std::vector<int>& missing : {std::vector<int>{kLeftHip}, {kRightHip}, {kLeftHip, kRightHip}, legs}) {
    Actor actor = actor_;
    for (int i : missing) actor.keypoints[i].bone = -1;
    EXPECT_TRUE(exchanged_legs(actor, camera_, pose, detected).empty()) << missing.size();
  }
  // An actor without toes still has feet.
  Actor actor = actor_;
  for (int i : {kLeftToe, kRightToe}) actor.keypoints[i].bone = -1;
  EXPECT_TRUE(holds(exchanged_legs(actor, camera_, pose, detected), seen(pose)));
}

TEST_F(LegExchange, NoNumbersAndNothingInViewGiveNone) {
  const Pose pose = test::standing_pose(actor_, 0);
  KeypointDetections undefined = exchanged(seen(pose), {kLeftKnee, kLeftAnkle, kLeftToe});
  undefined[kLeftAnkle].x_px = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(exchanged_legs(actor_, camera_, pose, undefined).empty());
  Pose behind = pose;
  behind.root_translation_mm.z() = -3000;
  EXPECT_TRUE(exchanged_legs(actor_, camera_, behind, seen(pose)).empty());
}

}  // namespace
}  // namespace livecap
