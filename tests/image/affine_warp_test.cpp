// The positions that kernels warp by are those of OpenCV's warp, and smaller pictures are its own, to the bit.
#include "image/affine_warp.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "livecap/error.h"

namespace livecap {
namespace {

ImageRgb noise(int width, int height) {
  ImageRgb image{width, height, std::vector<uint8_t>(size_t(3) * width * height)};
  std::mt19937 random(5);
  for (uint8_t& byte : image.pixels) byte = static_cast<uint8_t>(random());
  return image;
}

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

// The networks were tuned on OpenCV's means, and the device's crop is tested against the same.
TEST(AffineWarp, ShrinksToTheByteAsOpenCvDoes) {
  const ImageRgb image = noise(101, 67);
  const cv::Mat in(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data()));
  for (int factor = 1; factor <= 7; ++factor) {
    for (const cv::Rect& box : {cv::Rect(0, 0, 101, 67), cv::Rect(13, 5, 63, 41)}) {
      ImageRgb out;
      shrink(image, box.x, box.y, box.x + box.width, box.y + box.height, factor, out);
      ASSERT_EQ(out.width, box.width / factor);
      ASSERT_EQ(out.height, box.height / factor);
      cv::Mat expected;
      cv::resize(in(cv::Rect(box.x, box.y, out.width * factor, out.height * factor)), expected,
                 cv::Size(out.width, out.height), 0, 0, cv::INTER_AREA);
      const cv::Mat got(out.height, out.width, CV_8UC3, out.pixels.data());
      EXPECT_EQ(cv::norm(got, expected, cv::NORM_INF), 0) << "factor " << factor;
    }
  }
}

TEST(AffineWarp, ShrinkRefusesWhatIsNotInThePicture) {
  const ImageRgb image = noise(20, 10);
  ImageRgb out;
  EXPECT_THROW(shrink(image, 0, 0, 21, 10, 2, out), LogicError);
  EXPECT_THROW(shrink(image, -1, 0, 20, 10, 2, out), LogicError);
  EXPECT_THROW(shrink(image, 0, 0, 20, 10, 0, out), LogicError);
  shrink(image, 0, 0, 3, 3, 4, out);
  EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace livecap
