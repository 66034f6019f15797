#include "picture/rasterize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/tolerances.h"

namespace livecap {
namespace {

// Twice the signed area of (a, b, p), in double.
double side(const ScreenPoint& a, const ScreenPoint& b, double x, double y) {
  return (double(b.x) - a.x) * (y - a.y) - (double(b.y) - a.y) * (x - a.x);
}

TEST(Rasterize, CoversThePixelsInsideAndKeepsTheNearest) {
  constexpr int kWidth = 23, kHeight = 17;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> across(-8, 30), near(0.1f, 2);
  for (int round = 0; round < 200; ++round) {
    const ScreenPoint c[3] = {{across(random), across(random), near(random)},
                              {across(random), across(random), near(random)},
                              {across(random), across(random), near(random)}};
    NearnessImage image(kWidth, kHeight);
    const float there = near(random);  // what covers the left half already
    for (int i = 0; i < kWidth * kHeight; ++i) {
      if (i % kWidth < kWidth / 2) image.values[i] = there;
    }
    std::vector<int> painted(kWidth * kHeight, 0);
    rasterize(c, image, [&](int x, int y, const float(&w)[3], float nearness) {
      ++painted[y * kWidth + x];
      double px = 0, py = 0;
      for (int k = 0; k < 3; ++k) px += double(w[k]) * c[k].x, py += double(w[k]) * c[k].y;
      EXPECT_NEAR(px, x, test::kLinePx);
      EXPECT_NEAR(py, y, test::kLinePx);
      EXPECT_EQ(image.values[y * kWidth + x], nearness);
    });
    const double area = side(c[0], c[1], c[2].x, c[2].y);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        double least = 1, nearness = 0;
        for (int k = 0; k < 3; ++k) {
          const double share = side(c[(k + 1) % 3], c[(k + 2) % 3], x, y) / area;
          least = std::min(least, share);
          nearness += share * c[k].nearness;
        }
        const double before = x < kWidth / 2 ? there : -1;
        if (std::abs(least) < test::kLinePx || std::abs(nearness - before) < test::kLinePx) continue;
        EXPECT_EQ(painted[y * kWidth + x], least > 0 && nearness > before) << x << "," << y;
      }
    }
  }
}

TEST(Rasterize, NothingWithoutArea) {
  NearnessImage image(10, 10);
  rasterize({{1, 1, 1}, {5, 5, 1}, {9, 9, 1}}, image, [](int, int, const float(&)[3], float) { FAIL(); });
}

// Coordinates that no int holds.
TEST(Rasterize, CornersFarOut) {
  NearnessImage image(4, 4);
  int painted = 0;
  const auto count = [&](int x, int y, const float(&)[3], float) {
    ASSERT_TRUE(x >= 0 && x < 4 && y >= 0 && y < 4);
    ++painted;
  };
  for (const float sign : {-1.f, 1.f}) {
    rasterize({{sign * 4e9f, 0, 1}, {sign * 5e9f, 9, 1}, {sign * 6e9f, 0, 1}}, image, count);
    rasterize({{0, sign * 4e9f, 1}, {9, sign * 5e9f, 1}, {0, sign * 6e9f, 1}}, image, count);
  }
  rasterize({{1e30f, 0, 1}, {2e30f, 1e30f, 1}, {0, 2e30f, 1}}, image, count);
  rasterize({{std::nanf(""), 0, 1}, {3, 0, 1}, {0, 3, 1}}, image, count);
  EXPECT_EQ(painted, 0);
  rasterize({{-4e9f, -4e9f, 1}, {8e9f, -4e9f, 1}, {-4e9f, 8e9f, 1}}, image, count);
  EXPECT_EQ(painted, 16);
}

}  // namespace
}  // namespace livecap
