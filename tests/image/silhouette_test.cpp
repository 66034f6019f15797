#include "image/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// The definition: distance to the nearest pixel centre of the other side, less half a pixel.
float brute_force(const ImageGray& mask, int x, int y) {
  const bool inside = mask.pixels[size_t(y) * mask.width + x] > 127;
  double nearest = 1e9;
  for (int v = 0; v < mask.height; ++v) {
    for (int u = 0; u < mask.width; ++u) {
      if ((mask.pixels[size_t(v) * mask.width + u] > 127) != inside)
        nearest = std::min(nearest, std::hypot(u - x, v - y));
    }
  }
  return static_cast<float>(inside ? 0.5 - nearest : nearest - 0.5);
}

TEST(Silhouette, MatchesBruteForce) {
  std::mt19937 random(1);
  for (const auto& [width, height] : {std::pair{1, 7}, {31, 17}, {64, 63}, {65, 40}}) {
    for (int blobs : {1, 4}) {
      ImageGray mask{width, height, std::vector<uint8_t>(size_t(width) * height, 127)};
      int area = 0;
      for (int b = 0; b < blobs; ++b) {
        const int cx = random() % width, cy = random() % height, r = 1 + random() % 9;
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) {
            if (std::hypot(x - cx, y - cy) < r) mask.pixels[size_t(y) * width + x] = 128;
          }
        }
      }
      for (uint8_t p : mask.pixels) area += p > 127;
      if (area == width * height) continue;
      const Silhouette silhouette = make_silhouette(mask);
      EXPECT_EQ(silhouette.area_px, area);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          ASSERT_NEAR(silhouette.signed_distance[size_t(y) * width + x], brute_force(mask, x, y), test::kDistancePx)
              << x << "," << y;
        }
      }
    }
  }
}

TEST(Silhouette, NobodyIsEmptyAndEverybodyHasNoContour) {
  ImageGray mask{9, 5, std::vector<uint8_t>(45, 0)};
  const Silhouette nobody = make_silhouette(mask);
  EXPECT_TRUE(nobody.empty());
  EXPECT_TRUE(nobody.signed_distance.empty());
  EXPECT_EQ(nobody.width, 9);
  mask.pixels.assign(45, 255);
  const Silhouette full = make_silhouette(mask);
  EXPECT_EQ(full.area_px, 45);
  for (float d : full.signed_distance) EXPECT_EQ(d, -14);
  EXPECT_TRUE(make_silhouette(ImageGray{}).empty());
  mask.pixels.pop_back();
  EXPECT_THROW(make_silhouette(mask), LogicError);
}

}  // namespace
}  // namespace livecap
