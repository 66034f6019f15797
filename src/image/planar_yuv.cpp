#include "image/planar_yuv.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "base/all_vectors.h"

namespace livecap {
namespace {

constexpr int kShift = 14;       // of the coefficients
constexpr int kChromaShift = 4;  // chroma has 16 times its value
constexpr int kRounding = 1 << (kShift - 1);

struct Coefficients {
  int luma, luma_zero, red_cr, green_cb, green_cr, blue_cb;
};

Coefficients coefficients(const YuvCoding& coding) {
  const double green = 1 - coding.red - coding.blue;
  const double luma = coding.full_range ? 1 : 255.0 / 219, chroma = coding.full_range ? 1 : 255.0 / 224;
  const auto fixed = [](double x, int shift) { return static_cast<int>(std::lround(x * (1 << shift))); };
  const int bits = kShift - kChromaShift;
  return {fixed(luma, kShift),
          coding.full_range ? 0 : 16,
          fixed(2 * (1 - coding.red) * chroma, bits),
          fixed(-2 * (1 - coding.blue) * coding.blue / green * chroma, bits),
          fixed(-2 * (1 - coding.red) * coding.red / green * chroma, bits),
          fixed(2 * (1 - coding.blue) * chroma, bits)};
}

// Four times the chroma of a row that is three times as near to `near` as to `far`; one more on both sides. out: from
// the one before the first on.
LC_ALL_VECTORS void mix_rows(const uint8_t* near, const uint8_t* far, int n, uint16_t* __restrict out) {
  for (int i = 0; i < n; ++i) out[i + 1] = static_cast<uint16_t>(3 * near[i] + far[i]);
  out[0] = out[1];
  out[n + 1] = out[n];
}

// 16 times the chroma of each pixel, less that of grey. in: as mix_rows gives it. out: [2*n]
LC_ALL_VECTORS void spread_columns(const uint16_t* in, int n, int16_t* __restrict out) {
  for (int i = 0; i < n; ++i) {
    const int here = 3 * in[i + 1] - 16 * 128;
    out[2 * i] = static_cast<int16_t>(here + in[i]);
    out[2 * i + 1] = static_cast<int16_t>(here + in[i + 2]);
  }
}

LC_ALL_VECTORS void convert_row(const uint8_t* y, const int16_t* cb, const int16_t* cr, int n, const Coefficients& k,
                                uint8_t* __restrict red, uint8_t* __restrict green, uint8_t* __restrict blue) {
  const auto [luma, luma_zero, red_cr, green_cb, green_cr, blue_cb] = k;
  for (int x = 0; x < n; ++x) {
    const int grey = luma * (y[x] - luma_zero) + kRounding;
    red[x] = static_cast<uint8_t>(std::clamp((grey + red_cr * cr[x]) >> kShift, 0, 255));
    green[x] = static_cast<uint8_t>(std::clamp((grey + green_cb * cb[x] + green_cr * cr[x]) >> kShift, 0, 255));
    blue[x] = static_cast<uint8_t>(std::clamp((grey + blue_cb * cb[x]) >> kShift, 0, 255));
  }
}

}  // namespace

void rgb_from_yuv420(const PlanarYuv& yuv, const YuvCoding& coding, ImageRgb& out) {
  const int width = yuv.width, height = yuv.height;
  const int n_columns = (width + 1) / 2, n_rows = (height + 1) / 2;
  out.width = width;
  out.height = height;
  out.pixels.resize(size_t(3) * width * height);
  const Coefficients k = coefficients(coding);
  std::vector<uint16_t> mixed(n_columns + 2);
  std::vector<int16_t> chroma[2];
  for (auto& row : chroma) row.resize(size_t(2) * n_columns);
  std::vector<uint8_t> rgb(size_t(3) * width);
  const cv::Mat channels[3] = {cv::Mat(1, width, CV_8UC1, rgb.data()), cv::Mat(1, width, CV_8UC1, rgb.data() + width),
                               cv::Mat(1, width, CV_8UC1, rgb.data() + 2 * size_t(width))};
  for (int y = 0; y < height; ++y) {
    const int near = y / 2, far = std::clamp(y % 2 ? near + 1 : near - 1, 0, n_rows - 1);
    for (int c = 0; c < 2; ++c) {
      const uint8_t* plane = yuv.plane[c + 1];
      const ptrdiff_t stride = yuv.stride[c + 1];
      mix_rows(plane + near * stride, plane + far * stride, n_columns, mixed.data());
      spread_columns(mixed.data(), n_columns, chroma[c].data());
    }
    convert_row(yuv.plane[0] + ptrdiff_t(y) * yuv.stride[0], chroma[0].data(), chroma[1].data(), width, k, rgb.data(),
                rgb.data() + width, rgb.data() + 2 * size_t(width));
    cv::Mat row(1, width, CV_8UC3, out.pixels.data() + size_t(3) * width * y);
    cv::merge(channels, 3, row);
  }
}

}  // namespace livecap
