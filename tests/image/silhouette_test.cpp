#include "image/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "image/device_distance.h"
#include "livecap/error.h"
#include "support/kernel_bodies.h"
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
  for (const auto& [width, height] : {std::pair{1, 7}, {31, 17}, {64, 63}, {65, 40}, {150, 131}}) {
    for (int blobs : {1, 4}) {
      ImageGray mask{width, height, std::vector<uint8_t>(size_t(width) * height, 127)};
      int area = 0;
      int left = width, right = -1, top = height, bottom = -1;
      for (int b = 0; b < blobs; ++b) {
        const int cx = random() % width, cy = random() % height, r = 1 + random() % 9;
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) {
            if (std::hypot(x - cx, y - cy) < r) mask.pixels[size_t(y) * width + x] = 128;
          }
        }
      }
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          if (mask.pixels[size_t(y) * width + x] <= 127) continue;
          ++area;
          left = std::min(left, x), right = std::max(right, x);
          top = std::min(top, y), bottom = std::max(bottom, y);
        }
      }
      if (area == width * height) continue;
      const Silhouette silhouette = make_silhouette(mask);
      EXPECT_EQ(silhouette.area_px, area);
      const int margin = silhouette_margin_px(right - left + 1, bottom - top + 1);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          if (x < left - margin || x > right + margin || y < top - margin || y > bottom + margin) continue;
          ASSERT_NEAR(silhouette.signed_distance[size_t(y) * width + x], brute_force(mask, x, y), test::kDistancePx)
              << x << "," << y;
        }
      }
    }
  }
}

// Pieces anywhere, also far apart and at the border: the device's field is make_silhouette()'s.
TEST(Silhouette, TheDeviceComputesTheSame) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    std::mt19937 random(2);
    for (const auto& [width, height] :
         {std::pair{1, 7}, {9, 1}, {31, 17}, {64, 63}, {65, 140}, {301, 207}, {700, 90}}) {
      DeviceDistanceField field(device, width, height);
      for (int blobs : {1, 2, 30}) {
        ImageGray mask{width, height, std::vector<uint8_t>(size_t(width) * height, 0)};
        for (int b = 0; b < blobs; ++b) {
          const int cx = random() % width, cy = random() % height, r = 1 + random() % 40;
          for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
              if (std::hypot(x - cx, y - cy) < r) mask.pixels[size_t(y) * width + x] = b % 3 == 2 ? 0 : 255;
            }
          }
        }
        const Silhouette silhouette = make_silhouette(mask);
        if (silhouette.empty()) continue;
        ocl::Buffer<float> distance(device, mask.pixels.size());
        field.compute(ocl::Buffer<uint8_t>(device, mask.pixels), bounding_box(mask), silhouette.area_px, distance);
        const std::vector<float> found = distance.read_all();
        for (size_t p = 0; p < found.size(); ++p)
          ASSERT_NEAR(found[p], silhouette.signed_distance[p], test::kDistancePx)
              << p % width << "," << p / width << " of " << width << "x" << height << ", " << blobs << " blobs";
      }
    }
  });
}

// Between a mask and a part of it the contour may be anywhere.
TEST(Silhouette, AContourMayBeLeftOpen) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const auto& [width, height] : {std::pair{31, 17}, {64, 63}}) {
      ImageGray mask{width, height, std::vector<uint8_t>(size_t(width) * height, 0)}, part = mask;
      for (int y = 3; y < height - 2; ++y) {
        for (int x = 4; x < width - 3; ++x) {
          mask.pixels[size_t(y) * width + x] = 255;
          part.pixels[size_t(y) * width + x] = x < 2 * width / 3 ? 255 : 0;
        }
      }
      const Silhouette all = make_silhouette(mask), sure = make_silhouette(part);
      DeviceDistanceField field(device, width, height);
      ocl::Buffer<float> distance(device, all.signed_distance);
      field.leave_open(ocl::Buffer<float>(device, sure.signed_distance), distance);
      const std::vector<float> found = distance.read_all();
      int n_open = 0;
      for (size_t p = 0; p < found.size(); ++p) {
        const float of_all = all.signed_distance[p], of_part = sure.signed_distance[p];
        EXPECT_EQ(found[p], of_all > 0 ? of_all : of_part < 0 ? of_part : 0) << p % width << "," << p / width;
        n_open += found[p] == 0;
      }
      EXPECT_EQ(n_open, all.area_px - sure.area_px);
      EXPECT_THROW(field.leave_open(ocl::Buffer<float>(device, 5), distance), LogicError);
    }
  });
}

TEST(Silhouette, FarFromThePersonDistancesAreAnUpperBoundThatRises) {
  constexpr int kSize = 180, kFrom = 80, kTo = 99;  // a square person
  ImageGray mask{kSize, kSize, std::vector<uint8_t>(kSize * kSize, 0)};
  for (int y = kFrom; y <= kTo; ++y) {
    for (int x = kFrom; x <= kTo; ++x) mask.pixels[y * kSize + x] = 255;
  }
  const int margin = silhouette_margin_px(kTo - kFrom + 1, kTo - kFrom + 1);
  ASSERT_LT(margin, kFrom - 10);
  const Silhouette silhouette = make_silhouette(mask);
  const auto at = [&](int x, int y) { return silhouette.signed_distance[size_t(y) * kSize + x]; };
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float exact = brute_force(mask, x, y);
      ASSERT_GE(at(x, y), exact - test::kDistancePx) << x << "," << y;
      if (exact < 0) continue;
      // The way through the nearest pixel of the exact part is a detour of two sides of a triangle.
      ASSERT_LE(at(x, y), 2 * exact) << x << "," << y;
      // Straight beside the person the way is straight, too.
      if ((x >= kFrom && x <= kTo) || (y >= kFrom && y <= kTo)) {
        ASSERT_NEAR(at(x, y), exact, test::kDistancePx) << x << "," << y;
      }
    }
  }
  for (int k = 1; k < kFrom; ++k) {
    EXPECT_GT(at(k - 1, 90), at(k, 90)) << k;
    EXPECT_GT(at(k - 1, k - 1), at(k, k)) << k;
  }
}

// Columns 0 to 3 of 8 are foreground: distances go from -3.5 to 3.5, the same in all rows.
TEST(Silhouette, DistanceBetweenPixelsAndBeyondThePicture) {
  ImageGray mask{8, 4, std::vector<uint8_t>(32, 0)};
  for (int p = 0; p < 32; ++p) mask.pixels[p] = p % 8 < 4 ? 255 : 0;
  const Silhouette half = make_silhouette(mask);
  EXPECT_DOUBLE_EQ(distance_at(half, 2, 1), half.signed_distance[8 + 2]);
  EXPECT_DOUBLE_EQ(distance_at(half, 3.5, 1.25), (half.signed_distance[3] + half.signed_distance[4]) / 2.0);
  EXPECT_NEAR(distance_at(half, 9, 1), half.signed_distance[7] + 2, 0.002);  // the border is at 6.999
  EXPECT_NEAR(distance_at(half, 2, -3), half.signed_distance[2] + 3, 1e-12);
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
