#include "image/planar_yuv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace livecap {
namespace {

// ITU-R BT.601 and BT.709 in double, chroma between its four nearest samples.
double exact(const PlanarYuv& yuv, const YuvCoding& coding, int x, int y, int channel) {
  const int columns = (yuv.width + 1) / 2, rows = (yuv.height + 1) / 2;
  double c[2];
  for (int k = 0; k < 2; ++k) {
    const double u = std::clamp(0.5 * x - 0.25, 0.0, columns - 1.0), v = std::clamp(0.5 * y - 0.25, 0.0, rows - 1.0);
    const int i = static_cast<int>(u), j = static_cast<int>(v);
    const auto at = [&](int a, int b) {
      return double(yuv.plane[k + 1][std::min(b, rows - 1) * yuv.stride[k + 1] + std::min(a, columns - 1)]);
    };
    const double p = u - i, q = v - j;
    c[k] = (1 - q) * ((1 - p) * at(i, j) + p * at(i + 1, j)) + q * ((1 - p) * at(i, j + 1) + p * at(i + 1, j + 1));
  }
  const double luma = yuv.plane[0][y * yuv.stride[0] + x];
  const double grey = coding.full_range ? luma / 255 : (luma - 16) / 219;
  const double range = coding.full_range ? 255 : 224;
  const double cb = (c[0] - 128) / range, cr = (c[1] - 128) / range;
  const double red = grey + 2 * (1 - coding.red) * cr, blue = grey + 2 * (1 - coding.blue) * cb;
  const double green = (grey - coding.red * red - coding.blue * blue) / (1 - coding.red - coding.blue);
  return std::clamp(255 * (channel == 0 ? red : channel == 1 ? green : blue), 0.0, 255.0);
}

TEST(PlanarYuv, IsTheStandardsFormulaRounded) {
  std::mt19937 random(6);
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {63, 5}, {64, 6}, {65, 7}, {130, 41}}) {
    for (const YuvCoding& coding : {YuvCoding{}, YuvCoding{0.299, 0.114, false}, YuvCoding{0.2126, 0.0722, true}}) {
      std::vector<uint8_t> planes[3];
      const int strides[3] = {width + 5, (width + 1) / 2 + 3, (width + 1) / 2};
      for (int k = 0; k < 3; ++k) {
        planes[k].resize(size_t(strides[k]) * (k ? (height + 1) / 2 : height));
        for (uint8_t& value : planes[k]) value = static_cast<uint8_t>(k ? 90 + random() % 76 : random() % 256);
      }
      const PlanarYuv yuv{
          width, height, {planes[0].data(), planes[1].data(), planes[2].data()}, {strides[0], strides[1], strides[2]}};
      ImageRgb image;
      rgb_from_yuv420(yuv, coding, image);
      double sum = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          for (int c = 0; c < 3; ++c) {
            const double error = image.pixels[3 * (y * width + x) + c] - exact(yuv, coding, x, y, c);
            ASSERT_LT(std::abs(error), 0.6) << width << "x" << height << ": " << x << "," << y << " channel " << c;
            sum += error;
          }
        }
      }
      // No bias: a hundredth of a level is what is left of random roundings.
      if (width > 100) EXPECT_LT(std::abs(sum / (3.0 * width * height)), 0.02);
    }
  }
}

}  // namespace
}  // namespace livecap
