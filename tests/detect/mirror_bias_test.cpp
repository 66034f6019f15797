#include "detect/mirror_bias.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/tolerances.h"

namespace livecap {
namespace {

using detect::MirrorBias;

constexpr float kPx = 2, kMm = 20;  // what mirrored pictures add, others take away

// A keypoint that moves evenly, or along a slow arc, seen in turns.
MirrorBias::Keypoints seen(int frame, bool mirrored, float px, float mm, double arc) {
  MirrorBias::Keypoints keypoints{};
  const float sign = mirrored ? 1.0f : -1.0f;
  for (KeypointDetection& k : keypoints) {
    k.x_px = 100 + 3.0f * frame + sign * px;
    k.y_px = static_cast<float>(200 + arc * std::sin(0.1 * frame)) - sign * px;
    k.x_mm = -50 + 11.0f * frame + sign * mm;
    k.y_mm = 7;
    k.z_mm = static_cast<float>(300 + 10 * arc * std::cos(0.1 * frame)) - sign * mm;
  }
  return keypoints;
}

TEST(MirrorBias, WhatAlternatesIsTakenOut) {
  MirrorBias bias;
  for (int frame = 0; frame < 40; ++frame) {
    const bool mirrored = frame % 2;
    auto keypoints = seen(frame, mirrored, kPx, kMm, 10);
    bias.update(mirrored, keypoints);
    if (frame < 20) continue;
    const auto truth = seen(frame, mirrored, 0, 0, 10);
    for (int i = 0; i < kKeypointCount; ++i) {
      EXPECT_NEAR(keypoints[i].x_px, truth[i].x_px, 0.05 * kPx) << frame;
      EXPECT_NEAR(keypoints[i].y_px, truth[i].y_px, 0.05 * kPx) << frame;
      EXPECT_NEAR(keypoints[i].x_mm, truth[i].x_mm, 0.05 * kMm) << frame;
      EXPECT_NEAR(keypoints[i].z_mm, truth[i].z_mm, 0.05 * kMm) << frame;
    }
  }
}

TEST(MirrorBias, SteadyMotionIsLeftAsItIs) {
  MirrorBias bias;
  for (int frame = 0; frame < 10; ++frame) {
    auto keypoints = seen(frame, frame % 2, 0, 0, 0);
    bias.update(frame % 2, keypoints);
    const auto truth = seen(frame, frame % 2, 0, 0, 0);
    EXPECT_NEAR(keypoints[3].x_px, truth[3].x_px, test::kHandComputed);
    EXPECT_NEAR(keypoints[3].x_mm, truth[3].x_mm, test::kHandComputed);
  }
}

// Pictures of one kind on end say nothing of the other kind; nor do pictures with a gap between them.
TEST(MirrorBias, OnlyPicturesInTurnsTeach) {
  MirrorBias same, broken;
  for (int frame = 0; frame < 30; ++frame) {
    const auto jump = seen(frame % 3 ? 0 : 9, false, 0, 0, 0);
    auto keypoints = jump;
    same.update(false, keypoints);
    EXPECT_EQ(keypoints[0].x_px, jump[0].x_px);
    keypoints = jump;
    if (frame % 2 == 0) broken.interrupt();
    broken.update(frame % 2, keypoints);
    EXPECT_EQ(keypoints[0].x_px, jump[0].x_px);
  }
}

// A keypoint that jumps away and back teaches nothing.
TEST(MirrorBias, OneJumpIsNoBias) {
  MirrorBias bias;
  for (int frame = 0; frame < 12; ++frame) {
    auto keypoints = seen(0, frame % 2, 0, 0, 0);
    if (frame == 8) keypoints[5].x_px += 300;
    const float given = keypoints[5].x_px;
    bias.update(frame % 2, keypoints);
    EXPECT_EQ(keypoints[5].x_px, given) << frame;
  }
}

}  // namespace
}  // namespace livecap
