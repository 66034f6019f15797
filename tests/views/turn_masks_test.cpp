// Masks of somebody who turns before a wall of noise, drawn here.
#include "views/turn_masks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr int kPictureWidth = 180, kPictureHeight = 240, kViews = 24;

// A trunk that is wide from the front and narrow from the side, a head, arms; from the front one sees between the legs.
bool is_person(int view, double x, double y) {
  const double wide = std::abs(std::cos(2 * M_PI * view / kViews)), across = x - kPictureWidth / 2;
  if (std::hypot(across, y - 35) < 13) return true;                          // head
  if (y > 48 && y < 130 && std::abs(across) < 16 + 12 * wide) return true;   // trunk
  if (y > 60 && y < 72 && std::abs(across) < 20 + 45 * wide) return true;    // arms
  return y >= 130 && y < 220 && std::abs(std::abs(across) - 18 * wide) < 9;  // legs
}

struct Scene {
  ImageRgb wall{kPictureWidth, kPictureHeight, std::vector<uint8_t>(3 * kPictureWidth * kPictureHeight)};
  std::vector<View> views;
  std::vector<ImageGray> truth;
};

// The network's masks are the person moved by 2 px, another way in every view. moved_px: of the camera, from view to
// view.
Scene scene(int moved_px) {
  Scene scene;
  std::mt19937 random(3);
  for (int y = 0; y < kPictureHeight; ++y)
    for (int x = 0; x < kPictureWidth; ++x)
      for (int c = 0; c < 3; ++c)
        scene.wall.pixels[3 * (size_t(y) * kPictureWidth + x) + c] =
            static_cast<uint8_t>(150 + 30 * std::sin(x / 7.0 + c) + 30 * std::sin(y / 9.0 + 2 * c));
  for (int i = 0; i < kViews; ++i) {
    View view;
    view.image = scene.wall;
    view.mask = {kPictureWidth, kPictureHeight, std::vector<uint8_t>(kPictureWidth * kPictureHeight)};
    ImageGray truth = view.mask;
    const double aside = 2 * std::cos(2.4 * i), down = 2 * std::sin(2.4 * i);
    for (int y = 0; y < kPictureHeight; ++y)
      for (int x = 0; x < kPictureWidth; ++x) {
        const size_t p = size_t(y) * kPictureWidth + x;
        const size_t from = size_t(y) * kPictureWidth + (x + moved_px * i) % kPictureWidth;
        for (int c = 0; c < 3; ++c) {
          const int noise = static_cast<int>(random() % 5) - 2;
          const int color = is_person(i, x, y) ? 30 + 40 * c : scene.wall.pixels[3 * from + c];
          view.image.pixels[3 * p + c] = static_cast<uint8_t>(color + noise);
        }
        truth.pixels[p] = is_person(i, x, y) ? 255 : 0;
        view.mask.pixels[p] = is_person(i, x + aside, y + down) ? 255 : 0;
      }
    scene.views.push_back(view);
    scene.truth.push_back(truth);
  }
  return scene;
}

double mean_overlap(const Scene& scene) {
  double sum = 0;
  for (int i = 0; i < kViews; ++i) {
    int both = 0, either = 0;
    for (size_t p = 0; p < scene.truth[i].pixels.size(); ++p) {
      const bool a = scene.truth[i].pixels[p] > 127, b = scene.views[i].mask.pixels[p] > 127;
      both += a && b, either += a || b;
    }
    sum += static_cast<double>(both) / either / kViews;
  }
  return sum;
}

TEST(TurnMasks, TheTurnShowsTheWallBehindThePerson) {
  const Scene turn = scene(0);
  std::vector<ImageGray> masks;
  for (const View& view : turn.views) masks.push_back(view.mask);
  const TurnBackground background = find_background(turn.views, masks, 0.02);
  int n_known = 0;
  for (int y = 0; y < kPictureHeight; ++y)
    for (int x = 0; x < kPictureWidth; ++x) {
      const size_t p = size_t(y) * kPictureWidth + x;
      bool always = true;
      for (const ImageGray& mask : turn.truth) always = always && mask.pixels[p] > 0;
      if (always || background.known.pixels[p] == 0) continue;
      ++n_known;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(background.plate.pixels[3 * p + c], turn.wall.pixels[3 * p + c], test::kFilledPlate)
            << x << " " << y;
    }
  EXPECT_GT(n_known, kPictureWidth * kPictureHeight / 2);
  // In the middle of the trunk somebody is always.
  EXPECT_EQ(background.known.pixels[size_t(90) * kPictureWidth + kPictureWidth / 2], 0);
}

TEST(TurnMasks, AreSharperThanTheNetworks) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Scene turn = scene(0);
    const double before = mean_overlap(turn);
    ASSERT_TRUE(mask_by_background(device, turn.views));
    EXPECT_LT(before, 0.93);
    EXPECT_GT(mean_overlap(turn), 0.965);
  });
}

TEST(TurnMasks, OfAMovingCameraStayTheNetworks) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Scene turn = scene(5);
    const auto before = turn.views[3].mask.pixels;
    EXPECT_FALSE(mask_by_background(device, turn.views));
    EXPECT_EQ(turn.views[3].mask.pixels, before);
  });
}

TEST(TurnMasks, AViewWithoutAnybodySaysNothing) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Scene turn = scene(0);
    turn.views[5].mask = {};
    std::fill(turn.views[9].mask.pixels.begin(), turn.views[9].mask.pixels.end(), uint8_t{0});
    ASSERT_TRUE(mask_by_background(device, turn.views));
    EXPECT_TRUE(turn.views[5].mask.empty());
  });
}

}  // namespace
}  // namespace livecap
