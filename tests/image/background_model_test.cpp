// How a frame differs from the pictures of the empty scene.
#include "image/background_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace livecap {
namespace {

constexpr int kWallWidth = 300, kWallHeight = 200;

// A wall with a pattern; from x = first_other on it is brighter by 60 steps.
ImageRgb wall(float gain, int first_other = kWallWidth) {
  ImageRgb image{kWallWidth, kWallHeight, {}};
  for (int y = 0; y < kWallHeight; ++y) {
    for (int x = 0; x < kWallWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = 90 + 10 * c + 20 * std::sin(0.1f * x + 0.07f * y) + (x >= first_other ? 60 : 0);
        image.pixels.push_back(static_cast<uint8_t>(std::lround(value * gain)));
      }
    }
  }
  return image;
}

FrameChange change(const ImageRgb& frame, const ImageGray& ignore = {}) {
  BackgroundModel model;
  model.train(wall(1));
  return model.estimate_change(frame, ignore, 1);
}

TEST(BackgroundModel, OfOnePlateThePictureIsThePlate) {
  BackgroundModel model;
  EXPECT_TRUE(model.picture().pixels.empty());
  model.train(wall(1));
  EXPECT_EQ(model.picture().width, kWallWidth);
  EXPECT_EQ(model.picture().pixels, wall(1).pixels);
}

TEST(BackgroundModel, DriftOfTheLightIsNoChange) {
  for (const float gain : {0.85f, 1.0f, 1.2f}) {
    const FrameChange found = change(wall(gain));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.gain[c], gain, 0.01);
    EXPECT_EQ(found.changed, 0);
  }
}

TEST(BackgroundModel, WhatIsOtherIsToldByItsShare) {
  EXPECT_NEAR(change(wall(1, 4 * kWallWidth / 5)).changed, 0.2, 0.01);
  EXPECT_NEAR(change(wall(0.9f, 3 * kWallWidth / 5)).changed, 0.4, 0.01);
  // Not of the person, who is different anyway.
  ImageGray person{kWallWidth, kWallHeight, std::vector<uint8_t>(size_t(kWallWidth) * kWallHeight)};
  for (int y = 0; y < kWallHeight; ++y)
    std::fill_n(person.pixels.begin() + y * kWallWidth + kWallWidth / 2, kWallWidth / 2, 255);
  EXPECT_EQ(change(wall(1, kWallWidth / 2), person).changed, 0);
}

// A window is white in any light, and how white it would be in less of it nobody knows.
TEST(BackgroundModel, WhiteStaysWhite) {
  for (const float gain : {0.85f, 1.2f}) {
    ImageRgb plate = wall(1), frame = wall(gain);
    for (ImageRgb* image : {&plate, &frame}) std::fill_n(image->pixels.begin(), image->pixels.size() / 3, 255);
    BackgroundModel model;
    model.train(plate);
    EXPECT_EQ(model.estimate_change(frame, {}, 1).changed, 0) << gain;
  }
}

TEST(BackgroundModel, ABlackPlateIsAnotherScene) {
  BackgroundModel model;
  model.train({kWallWidth, kWallHeight, std::vector<uint8_t>(size_t(3) * kWallWidth * kWallHeight, 0)});
  EXPECT_EQ(model.estimate_change(wall(1), {}, 1).changed, 1);
}

TEST(BackgroundModel, AnotherLightIsNoDrift) {
  EXPECT_EQ(change(wall(1.9f)).changed, 1);
}

}  // namespace
}  // namespace livecap
