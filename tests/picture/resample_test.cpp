#include "picture/resample.h"

#include <gtest/gtest.h>

namespace livecap {
namespace {

TEST(Resample, AveragesWhatWasRepeated) {
  ImageRgb image{3, 2, {}};
  for (int i = 0; i < 18; ++i) image.pixels.push_back(static_cast<uint8_t>(13 * i));
  for (int n : {1, 2, 3}) {
    const ImageRgb large = repeated(image, n);
    ASSERT_EQ(large.width, 3 * n);
    ASSERT_EQ(large.height, 2 * n);
    EXPECT_EQ(large.pixels[3 * ((2 * n - 1) * 3 * n + 3 * n - 1) + 2], image.pixels[17]);  // the last pixel's blue
    EXPECT_EQ(averaged(large, n).pixels, image.pixels);
  }
}

TEST(Resample, RoundsAndCutsOffTheRest) {
  const ImageRgb image{3, 2, {0, 10, 0, 1, 10, 0, 99, 99, 99, 1, 10, 0, 0, 11, 255, 99, 99, 99}};
  const ImageRgb small = averaged(image, 2);
  ASSERT_EQ(small.width, 1);
  ASSERT_EQ(small.height, 1);
  EXPECT_EQ(small.pixels, (std::vector<uint8_t>{1, 10, 64}));  // 0.5, 10.25, 63.75
}

}  // namespace
}  // namespace livecap
