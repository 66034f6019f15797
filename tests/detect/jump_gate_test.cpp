#include "detect/jump_gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "livecap/error.h"

namespace livecap {
namespace {

using Keypoints = std::array<KeypointDetection, kKeypointCount>;

constexpr double kDt = 1.0 / 30;
constexpr double kMmPerPx = 4;

// All at rest, the left wrist apart, but the right wrist, in px; z and confidence of each tell the frame.
Keypoints frame(int i, double x_px, double y_px = 0) {
  Keypoints k{};
  for (KeypointDetection& point : k) {
    point.z_mm = static_cast<float>(i);
    point.confidence = 1 - 0.01f * static_cast<float>(i);
  }
  k[kLeftWrist].x_px = -200;
  k[kRightWrist].x_px = static_cast<float>(x_px);
  k[kRightWrist].y_px = static_cast<float>(y_px);
  return k;
}

TEST(JumpGate, OneFrameThatNoHandCanFollowIsLeftOut) {
  for (double jump_px : {60.0, 80.0}) {  // 240 and 320 mm; 250 are allowed in a thirtieth of a second
    detect::JumpGate gate;
    for (int i = 0; i < 20; ++i) {
      const bool jumps = i == 10 && jump_px > 62.5;
      Keypoints k = frame(i, i == 10 ? jump_px : i);
      EXPECT_EQ(gate.update({}, kDt, kMmPerPx, k), jumps) << i;
      EXPECT_FLOAT_EQ(k[kRightWrist].z_mm, static_cast<float>(jumps ? 9 : i)) << i;
      EXPECT_FLOAT_EQ(k[kRightWrist].confidence, 1 - 0.01f * k[kRightWrist].z_mm) << i;
      EXPECT_FLOAT_EQ(k[kLeftWrist].z_mm, static_cast<float>(i)) << i;
      if (jumps) {
        EXPECT_FLOAT_EQ(k[kRightWrist].x_px, 9) << i;
      }
    }
  }
}

TEST(JumpGate, HandsMayBeFast) {
  detect::JumpGate gate;
  double x_mm = 0, speed = 0;
  for (int i = 0; i < 40; ++i) {  // to 12 m/s and back, 80 m/s^2
    speed += (i % 20 < 5 ? 80e3 : i % 20 < 10 ? -80e3 : 0) * kDt;
    x_mm += speed * kDt;
    Keypoints k = frame(i, x_mm / kMmPerPx);
    EXPECT_FALSE(gate.update({}, kDt, kMmPerPx, k)) << i << ", m/s: " << speed / 1000;
  }
  EXPECT_GT(x_mm, 1000);
}

TEST(JumpGate, WhatStaysAwayIsBelieved) {
  detect::JumpGate gate;
  int believed = -1;
  for (int i = 0; i < 30; ++i) {
    Keypoints k = frame(i, i < 10 ? 0 : 300);
    const bool any = gate.update({}, kDt, kMmPerPx, k);
    if (i < 10) {
      EXPECT_FALSE(any) << i;
    } else if (!any && believed < 0) {
      believed = i;
    }
    if (believed >= 0) {
      EXPECT_FLOAT_EQ(k[kRightWrist].x_px, 300) << i;
      EXPECT_FLOAT_EQ(k[kRightWrist].z_mm, static_cast<float>(i)) << i;
    }
  }
  EXPECT_EQ(believed, 13);  // 0.1 s
}

TEST(JumpGate, LongerGapsAllowMore) {
  for (double dt_s : {kDt, 0.2}) {
    detect::JumpGate gate;
    Keypoints k = frame(0, 0);
    gate.update({}, dt_s, kMmPerPx, k);
    k = frame(1, 100);  // 400 mm
    EXPECT_EQ(gate.update({}, dt_s, kMmPerPx, k), dt_s == kDt);
  }
}

TEST(JumpGate, ExchangedSidesHaveNotJumped) {
  detect::JumpGate gate;
  for (int i = 0; i < 20; ++i) {
    Keypoints k = frame(i, 150);
    if (i == 10) std::swap(k[kLeftWrist], k[kRightWrist]);
    EXPECT_FALSE(gate.update({}, kDt, kMmPerPx, k)) << i;
    EXPECT_FLOAT_EQ(k[kRightWrist].x_px, i == 10 ? -200 : 150) << i;
  }
}

TEST(JumpGate, AnotherPictureIsBelieved) {
  detect::JumpGate gate;
  for (int i = 0; i < 20; ++i) {
    Keypoints k = frame(i, i);
    for (KeypointDetection& point : k) point.y_px += i < 10 ? 0 : 500;
    const Keypoints seen = k;
    EXPECT_FALSE(gate.update({}, kDt, kMmPerPx, k)) << i;
    for (int p = 0; p < kKeypointCount; ++p) EXPECT_EQ(k[p].y_px, seen[p].y_px) << i;
  }
}

TEST(JumpGate, BadOptionsAreRefused) {
  for (const detect::JumpGateOptions& bad :
       {detect::JumpGateOptions{0, 3000, 0.1}, detect::JumpGateOptions{150, -1, 0.1},
        detect::JumpGateOptions{150, 3000, -0.1}, detect::JumpGateOptions{150, NAN, 0.1}})
    EXPECT_THROW(bad.validate(), ConfigError);
  EXPECT_NO_THROW(detect::JumpGateOptions{}.validate());
}

}  // namespace
}  // namespace livecap
