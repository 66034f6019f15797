#include "detect/side_tracker.h"

#include <gtest/gtest.h>

#include <utility>

#include "livecap/error.h"

namespace livecap {
namespace {

using Keypoints = std::array<KeypointDetection, kKeypointCount>;

// Somebody standing, arms and legs apart, shifted by `x` mm.
Keypoints person(float x) {
  Keypoints k{};
  const std::pair<Keypoint, Keypoint> sides[] = {
      {kLeftShoulder, kRightShoulder}, {kLeftElbow, kRightElbow}, {kLeftWrist, kRightWrist}, {kLeftHand, kRightHand},
      {kLeftHip, kRightHip},           {kLeftKnee, kRightKnee},   {kLeftAnkle, kRightAnkle}, {kLeftToe, kRightToe}};
  float half = 100;
  for (const auto& [left, right] : sides) {
    k[left].x_mm = x + half;
    k[right].x_mm = x - half;
    k[left].y_mm = k[right].y_mm = 2 * half;
    k[left].x_px = k[left].x_mm / 4;
    k[right].x_px = k[right].x_mm / 4;
    half += 20;
  }
  return k;
}

Keypoints exchanged(Keypoints k) {
  for (int left : {kLeftHip, kLeftShoulder, kLeftElbow, kLeftWrist, kLeftHand, kLeftKnee, kLeftAnkle, kLeftToe})
    std::swap(k[left], k[left + 1]);
  return k;
}

constexpr double kFrameS = 1.0 / 30;

TEST(SideTracker, UndoesASuddenExchange) {
  detect::SideTracker tracker;
  for (int i = 0; i < 60; ++i) {
    const bool wrong = i >= 30 && i < 45;
    Keypoints k = wrong ? exchanged(person(i)) : person(i);
    EXPECT_EQ(tracker.update({}, kFrameS, 4, k), wrong) << i;
    EXPECT_EQ(k[kLeftWrist].x_mm, person(i)[kLeftWrist].x_mm) << i;
    EXPECT_EQ(k[kRightAnkle].x_px, person(i)[kRightAnkle].x_px) << i;
  }
}

TEST(SideTracker, BelievesANetworkThatInsists) {
  detect::SideTracker tracker;
  Keypoints k = exchanged(person(0));  // a wrong beginning
  tracker.update({}, kFrameS, 4, k);
  int healed = -1;
  for (int i = 0; i < 60 && healed < 0; ++i) {
    k = person(i);
    if (!tracker.update({}, kFrameS, 4, k)) healed = i;
    EXPECT_EQ(tracker.changed_sides(), healed >= 0) << i;
  }
  EXPECT_GE(healed, 3);
  EXPECT_LE(healed, 10);
}

TEST(SideTracker, LegsFollowTheShoulders) {
  detect::SideTracker tracker;
  Keypoints first = person(0);
  tracker.update({}, kFrameS, 4, first);
  // Only the legs are exchanged: hips that face away from the shoulders are put right.
  Keypoints k = exchanged(person(1));
  const Keypoints right = person(1);
  for (int i : {kLeftShoulder, kRightShoulder, kLeftElbow, kRightElbow, kLeftWrist, kRightWrist, kLeftHand, kRightHand})
    k[i] = right[i];
  EXPECT_TRUE(tracker.update({}, kFrameS, 4, k));
  EXPECT_EQ(k[kLeftHip].x_mm, right[kLeftHip].x_mm);
  EXPECT_EQ(k[kLeftShoulder].x_mm, right[kLeftShoulder].x_mm);
}

// A network that takes the front for the back names the sides wrongly and gives the depths of somebody who faces away.
TEST(SideTracker, DepthOfAnExchangedFrameIsNotTaken) {
  const auto with_depth = [](Keypoints k, float arms, float legs) {
    for (int i = kHeadTop; i < kKeypointCount; ++i) {
      const bool leg = i == kLeftHip || i == kRightHip || (i >= kLeftKnee && i <= kRightToe);
      k[i].z_mm = leg ? legs : arms;
    }
    return k;
  };
  detect::SideTracker tracker;
  for (int i = 0; i < 30; ++i) {
    const bool wrong = i >= 20 && i < 26;
    Keypoints k = person(0);
    k[kLeftEye].x_px = 5;
    k[kRightEye].x_px = -5;
    k = with_depth(k, -100.0f - i, 50.0f + i);
    if (wrong) {
      k = with_depth(exchanged(k), 100, -50);
      std::swap(k[kLeftEye], k[kRightEye]);
    }
    EXPECT_EQ(tracker.update({}, kFrameS, 4, k), wrong) << i;
    const float last_agreed = wrong ? 19.0f : float(i);
    for (int arm : {kNeck, kLeftShoulder, kRightWrist, kNose, kLeftEye})
      EXPECT_EQ(k[arm].z_mm, -100 - last_agreed) << i << " " << arm;
    for (int leg : {kLeftHip, kRightKnee, kLeftToe}) EXPECT_EQ(k[leg].z_mm, 50 + last_agreed) << i << " " << leg;
    EXPECT_EQ(k[kLeftEye].x_px, 5) << i;
  }
}

TEST(SideTracker, BadOptionsAreRefused) {
  EXPECT_THROW((detect::SideTrackerOptions{0, 1}.validate()), ConfigError);
}

}  // namespace
}  // namespace livecap
