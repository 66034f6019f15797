// A shoe with a light cap on a patterned floor, drawn here, in the shadow that is darkest where it stands.
#include "views/foot_masks.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "image/mask_iou.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr int kFootWidth = 160, kFootHeight = 420;
constexpr double kSoleY = 396, kAnkleX = 80;

double beyond_shoe(double x, double y) {  // px, roughly; negative inside
  const double u = (x - 92) / 30, v = (y - kSoleY) / 9;
  return (std::hypot(u, v) - 1) * 9;
}
bool is_shoe(double x, double y) {
  return beyond_shoe(x, y) < 0;
}
bool is_cap(double x, double y) {
  return is_shoe(x, y) && x > 108;
}
bool is_leg(double x, double y) {
  return y > 20 && y < kSoleY - 4 && std::abs(x - kAnkleX) < 11;
}
bool is_person(double x, double y) {
  return is_shoe(x, y) || is_leg(x, y);
}

ImageGray drawn(bool (*is)(double, double)) {
  ImageGray mask{kFootWidth, kFootHeight, std::vector<uint8_t>(size_t(kFootWidth) * kFootHeight)};
  for (int y = 0; y < kFootHeight; ++y)
    for (int x = 0; x < kFootWidth; ++x) mask.pixels[size_t(y) * kFootWidth + x] = is(x, y) ? 255 : 0;
  return mask;
}

struct Floor {
  ImageRgb plate{kFootWidth, kFootHeight, std::vector<uint8_t>(3 * size_t(kFootWidth) * kFootHeight)};
  ImageRgb image = plate;
  ImageGray known{kFootWidth, kFootHeight, std::vector<uint8_t>(size_t(kFootWidth) * kFootHeight, 255)};
  ImageGray truth = drawn(is_person);
};

Floor draw_floor() {
  Floor floor;
  std::mt19937 random(5);
  for (int y = 0; y < kFootHeight; ++y)
    for (int x = 0; x < kFootWidth; ++x) {
      const double tiles = ((x / 17 + y / 13) % 2 != 0 ? 30 : 0) + 12 * std::sin(x / 5.0);
      // A shadow around the shoe, and a long one to the left.
      const double near = std::exp(-std::max(0.0, beyond_shoe(x, y)) / 7);
      const double cast = std::exp(-0.5 * (std::pow((x - 45) / 22.0, 2) + std::pow((y - kSoleY) / 9.0, 2)));
      const double light = (1 - 0.4 * near) * (1 - 0.35 * cast);
      for (int c = 0; c < 3; ++c) {
        const size_t p = 3 * (size_t(y) * kFootWidth + x) + c;
        const double empty = 135 + tiles + 4 * c;
        const std::array<double, 3> dark = {30, 110, 60}, skin = {200, 160, 140};
        const double seen = is_cap(x, y) ? 150 : is_shoe(x, y) ? dark[c] : is_leg(x, y) ? skin[c] : light * empty;
        const auto noisy = [&](double value) { return static_cast<uint8_t>(value + random() % 5 - 2.0); };
        floor.plate.pixels[p] = noisy(empty);
        floor.image.pixels[p] = noisy(seen);
      }
    }
  return floor;
}

double feet_iou(const ImageGray& mask, const ImageGray& truth) {
  constexpr int kFirstRow = 360;
  const auto lowest = [](const ImageGray& all) {
    return ImageGray{
        kFootWidth, kFootHeight - kFirstRow, {all.pixels.begin() + size_t(kFirstRow) * kFootWidth, all.pixels.end()}};
  };
  return mask_iou(lowest(mask), lowest(truth));
}

// What the difference to the empty floor gives: the cap is lost, the darkest of the shadow is not told from a shoe.
bool without_cap(double x, double y) {
  return is_person(x, y) && !is_cap(x, y);
}
bool with_shadow(double x, double y) {
  return without_cap(x, y) || (beyond_shoe(x, y) < 8 && x < 108 && y > kSoleY - 12);
}

TEST(FootMasks, AShoesLightCapIsItsOwnAndTheShadowTheFloors) {
  const Floor floor = draw_floor();
  for (const auto start : {is_person, without_cap, with_shadow}) {
    ImageGray mask = drawn(start);
    cut_feet_from_shadows(floor.plate, floor.known, floor.image, mask);
    EXPECT_GT(feet_iou(mask, floor.truth), test::kCutFeetIou);
  }
  EXPECT_LT(feet_iou(drawn(with_shadow), floor.truth), test::kUncutFeetIou) << "else there was nothing to do";
}

TEST(FootMasks, AboveTheFeetTheMaskStays) {
  const Floor floor = draw_floor();
  ImageGray mask = drawn(with_shadow);
  for (int y = 100; y < 110; ++y)
    for (int x = 0; x < 30; ++x) mask.pixels[size_t(y) * kFootWidth + x] = 255;
  const ImageGray before = mask;
  cut_feet_from_shadows(floor.plate, floor.known, floor.image, mask);
  EXPECT_TRUE(std::equal(mask.pixels.begin(), mask.pixels.begin() + 340 * kFootWidth, before.pixels.begin()));
}

TEST(FootMasks, WhereTheEmptySceneIsNotKnownTheMaskStays) {
  Floor floor = draw_floor();
  const ImageGray before = drawn(with_shadow);
  floor.known.pixels.assign(floor.known.pixels.size(), 0);
  ImageGray mask = before;
  cut_feet_from_shadows(floor.plate, floor.known, floor.image, mask);
  for (size_t p = 0; p < mask.pixels.size(); ++p)
    if (before.pixels[p] != 0) ASSERT_EQ(mask.pixels[p], 255) << p;
}

TEST(FootMasks, NobodyStaysNobodyAndTheBordersAreNoLimit) {
  const Floor floor = draw_floor();
  ImageGray mask = drawn([](double, double) { return false; });
  cut_feet_from_shadows(floor.plate, floor.known, floor.image, mask);
  EXPECT_EQ(mask.pixels, drawn([](double, double) { return false; }).pixels);
  for (const auto everywhere : {+[](double, double) { return true; }, +[](double x, double y) { return x + y < 1; }}) {
    mask = drawn(everywhere);
    cut_feet_from_shadows(floor.plate, floor.known, floor.image, mask);
    EXPECT_EQ(mask.pixels.size(), floor.known.pixels.size());
  }
}

}  // namespace
}  // namespace livecap
