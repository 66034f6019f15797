// The positions that kernels warp by are those of OpenCV's warp, to the bit.
#include "image/affine_warp.h"

#include <gtest/gtest.h>

#include <random>

namespace livecap {
namespace {

TEST(AffineWarp, FixedStepsGiveOpenCvsPixels) {
  constexpr int kWidth = 90, kHeight = 70, kSize = 64;
  std::mt19937 random(2);
  ImageGray in{kWidth, kHeight, {}};
  for (int i = 0; i < kWidth * kHeight; ++i) in.pixels.push_back(static_cast<uint8_t>(random()));
  const auto at = [&](int x, int y) {
    return x < 0 || y < 0 || x >= kWidth || y >= kHeight ? 0 : int{in.pixels[size_t(y) * kWidth + x]};
  };
  for (const AffineMap& map : {AffineMap{0.9, 0.1, 3.3, -0.1, 0.9, 5.7}, AffineMap{1, 0, 0.5, 0, 1, 0.25},
                               AffineMap{-1.7, 0.6, 80, -0.6, -0.7, 71.1}, AffineMap{1, 0, 3, 0, 1, 4}}) {
    ImageGray expected{kSize, kSize, std::vector<uint8_t>(size_t(kSize) * kSize)};
    warp_affine(in, map, expected);
    const std::vector<int32_t> steps = fixed_steps(map, kSize, kSize);
    ASSERT_EQ(steps.size(), size_t(4) * kSize);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        // As warp_point.h.
        const int px = (steps[2 * x] + steps[2 * (kSize + y)]) >> 5;
        const int py = (steps[2 * x + 1] + steps[2 * (kSize + y) + 1]) >> 5;
        const int u = px >> 5, v = py >> 5, fx = px & 31, fy = py & 31;
        const int top = at(u, v) * (32 - fx) + at(u + 1, v) * fx;
        const int bottom = at(u, v + 1) * (32 - fx) + at(u + 1, v + 1) * fx;
        ASSERT_EQ((top * (32 - fy) + bottom * fy + 512) >> 10, int{expected.pixels[size_t(y) * kSize + x]})
            << x << " " << y;
      }
    }
  }
}

}  // namespace
}  // namespace livecap
