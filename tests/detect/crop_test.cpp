#include "detect/crop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/tolerances.h"

namespace livecap {
namespace {

using detect::CropRegion;
using detect::Point2;

// A smooth picture: linear ramps survive bilinear sampling and block averages exactly (up to 8 bits).
ImageRgb ramps(int width, int height) {
  ImageRgb image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels.push_back(static_cast<uint8_t>(x));
      image.pixels.push_back(static_cast<uint8_t>(y));
      image.pixels.push_back(static_cast<uint8_t>((x + y) / 2));
    }
  }
  return image;
}

TEST(Crop, PositionsSurviveARoundTrip) {
  const CropRegion crop{123.4, -56.7, 345.6, 0.7};
  for (Point2 p : {Point2{0, 0}, Point2{1, 0.25}, Point2{-0.3, 2}}) {
    const Point2 back = crop.crop_from_image(crop.image_from_crop(p));
    EXPECT_NEAR(back.x, p.x, test::kDoubleExact);
    EXPECT_NEAR(back.y, p.y, test::kDoubleExact);
  }
}

TEST(Crop, AngleTurnsUpTowardsTheRight) {
  const CropRegion crop{10, 20, 8, M_PI / 2};
  const Point2 top = crop.image_from_crop({0.5, 0});
  EXPECT_NEAR(top.x, 14, test::kDoubleExact);
  EXPECT_NEAR(top.y, 20, test::kDoubleExact);
}

TEST(Crop, IdentityCropReturnsThePixels) {
  const ImageRgb image = ramps(32, 32);
  ImageRgb out;
  detect::CropSampler().sample(image, detect::whole_image_crop(32, 32), 32, out);
  for (size_t i = 0; i < out.pixels.size(); ++i) ASSERT_NEAR(out.pixels[i], image.pixels[i], test::kByteRounding);
}

// Enlarged, shrunk and turned crops of a ramp read the ramp's value at each crop pixel's own image position.
TEST(Crop, SamplesAreWhereTheTransformSays) {
  const ImageRgb image = ramps(250, 240);
  const int size = 64;
  for (const CropRegion& crop : {CropRegion{120, 120, 30, 0.4}, CropRegion{125, 118, 96, -1.1},
                                 CropRegion{120, 120, 150, 2.0}, CropRegion{124.3, 119.6, 200, 0}}) {
    ImageRgb out;
    detect::CropSampler().sample(image, crop, size, out);
    for (int v = 0; v < size; ++v) {
      for (int u = 0; u < size; ++u) {
        const Point2 p = crop.image_from_crop({(u + 0.5) / size, (v + 0.5) / size});
        if (p.x < 4 || p.y < 4 || p.x > 245 || p.y > 235) continue;
        ASSERT_NEAR(out.pixels[3 * (v * size + u)], p.x, test::kSampledBytes) << crop.side_px;
        ASSERT_NEAR(out.pixels[3 * (v * size + u) + 1], p.y, test::kSampledBytes) << crop.side_px;
      }
    }
  }
}

TEST(Crop, OutsideTheImageIsBlack) {
  ImageRgb image{40, 20, std::vector<uint8_t>(3 * 40 * 20, 200)};
  ImageRgb out;
  detect::CropSampler().sample(image, detect::whole_image_crop(40, 20), 40, out);
  EXPECT_EQ(out.pixels[3 * (2 * 40 + 20)], 0);
  EXPECT_NEAR(out.pixels[3 * (20 * 40 + 20)], 200, test::kByteRounding);
  detect::CropSampler().sample(image, {-500, -500, 30, 0}, 40, out);
  EXPECT_EQ(*std::max_element(out.pixels.begin(), out.pixels.end()), 0);
}

// A fine checkerboard becomes grey, not a moire pattern.
TEST(Crop, ShrinkingAverages) {
  ImageRgb image{512, 512, {}};
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 3 * 512; ++x) image.pixels.push_back((x / 3 + y) % 2 ? 255 : 0);
  }
  ImageRgb out;
  detect::CropSampler().sample(image, {255.5, 255.5, 256, 0.3}, 64, out);
  for (int v : out.pixels) ASSERT_NEAR(v, 127.5, test::kByteRounding);
}

TEST(Crop, MaskLandsWhereItWasSeen) {
  const int size = 64;
  const CropRegion crop{70, 55, 60, 0.5};
  ImageGray mask{size, size, std::vector<uint8_t>(size * size)};
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u)
      mask.pixels[v * size + u] = uint8_t(255 * (u + 0.5f) / size + 0.5f);  // rises to the right of the crop
  }
  PersonMask out;
  detect::warp_mask(mask, crop, 140, 100, out);
  ASSERT_EQ(out.probability.size(), 140u * 100u);
  int inside = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 140; ++x) {
      const Point2 p = crop.crop_from_image({double(x), double(y)});
      const int value = out.probability[y * 140 + x];
      if (p.x < -0.01 || p.x > 1.01 || p.y < -0.01 || p.y > 1.01) {
        ASSERT_EQ(value, 0) << x << "," << y;
      } else if (p.x > 0.01 && p.x < 0.99 && p.y > 0.01 && p.y < 0.99) {
        ASSERT_NEAR(value, 255 * p.x, test::kSampledBytes) << x << "," << y;
        ++inside;
      }
    }
  }
  EXPECT_GT(inside, 3000);
}

// What is left out because nobody is there would have been black.
TEST(Crop, MaskOfASmallPartIsThatOfTheWhole) {
  for (const CropRegion& crop :
       {CropRegion{70, 50, 120, 0.4}, CropRegion{20, 90, 60, -2.5}, CropRegion{140, 5, 300, 0}}) {
    ImageGray mask{64, 64, std::vector<uint8_t>(64 * 64, 0)};
    for (int y = 20; y < 45; ++y) {
      for (int x = 30; x < 64; ++x) mask.pixels[y * 64 + x] = static_cast<uint8_t>(60 + 3 * x + y % 5);
    }
    PersonMask out;
    out.probability.assign(7, 99);  // what is there from the frame before is cleared
    detect::warp_mask(mask, crop, 140, 100, out);
    int seen = 0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 140; ++x) {
        const Point2 p = crop.crop_from_image({double(x), double(y)});
        const double u = 64 * p.x - 0.5, v = 64 * p.y - 0.5;
        const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
        const auto at = [&](int a, int b) {
          return a < 0 || b < 0 || a > 63 || b > 63 ? 0.0 : mask.pixels[b * 64 + a];
        };
        const double a = u - i, b = v - j;
        const double expected =
            (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) + b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
        // OpenCV's positions are rounded to 1/32 pixel; a step of 250 levels is at the blob's border.
        ASSERT_NEAR(out.probability[y * 140 + x], expected, 2 * 250 / 32.0 + 1) << x << "," << y;
        seen += out.probability[y * 140 + x] > 0;
      }
    }
    EXPECT_GT(seen, 300);
  }
}

}  // namespace
}  // namespace livecap
