#include "image/affine_warp.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/all_vectors.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// type: CV_8UC3 or CV_8UC1.
template <typename Image>
cv::Mat view(const Image& image, int type) {
  if (image.pixels.size() != size_t(CV_MAT_CN(type)) * image.width * image.height)
    throw LogicError("affine_warp: the pixels do not match the picture's size");
  return cv::Mat(image.height, image.width, type, const_cast<uint8_t*>(image.pixels.data()));
}

template <typename Image>
void warp(const Image& in, const AffineMap& map, Image& out, int type) {
  cv::Mat to = view(out, type);
  if (in.empty() || out.empty()) {
    to.setTo(0);
    return;
  }
  const cv::Matx23d matrix(map.xx, map.xy, map.x0, map.yx, map.yy, map.y0);
  cv::warpAffine(view(in, type), to, matrix, to.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT);
}

// Sums of `factor` rows of n bytes, `pitch` bytes apart.
LC_ALL_VECTORS void sum_rows(const uint8_t* rows, size_t pitch, int factor, int n, uint32_t* __restrict sums) {
  for (int i = 0; i < n; ++i) sums[i] = rows[i];
  for (int k = 1; k < factor; ++k) {
    const uint8_t* row = rows + k * pitch;
    for (int i = 0; i < n; ++i) sums[i] += row[i];
  }
}

// Halves to the even one; x in 0..255.
uint8_t nearest_byte(float x) {
  constexpr float kNoFractions = 0x1.8p23f;
  return static_cast<uint8_t>(x + kNoFractions - kNoFractions);
}

// n means of blocks as OpenCV rounds them, each of `factor` sums of a channel three apart.
void mean_of_blocks(const uint32_t* sums, int factor, int n, uint8_t* out) {
  const float share = 1.0f / static_cast<float>(factor * factor);
  for (int b = 0; b < n; ++b, sums += 3 * factor) {
    for (int c = 0; c < 3; ++c) {
      uint32_t sum = 0;
      for (int k = 0; k < factor; ++k) sum += sums[3 * k + c];
      *out++ = factor == 2 ? uint8_t((sum + 2) >> 2) : nearest_byte(static_cast<float>(sum) * share);
    }
  }
}

}  // namespace

void warp_affine(const ImageRgb& in, const AffineMap& in_from_out, ImageRgb& out) {
  warp(in, in_from_out, out, CV_8UC3);
}

void warp_affine(const ImageGray& in, const AffineMap& in_from_out, ImageGray& out) {
  warp(in, in_from_out, out, CV_8UC1);
}

void warp_affine(const ImageGray& in, const AffineMap& map, int x_begin, int y_begin, int x_end, int y_end,
                 ImageGray& out) {
  if (x_begin < 0 || y_begin < 0 || x_end > out.width || y_end > out.height)
    throw LogicError("warp_affine: the rectangle is not inside the picture");
  if (x_end <= x_begin || y_end <= y_begin) return;
  cv::Mat to = view(out, CV_8UC1)(cv::Rect(x_begin, y_begin, x_end - x_begin, y_end - y_begin));
  const cv::Matx23d matrix(map.xx, map.xy, map.x0 + map.xx * x_begin + map.xy * y_begin,  //
                           map.yx, map.yy, map.y0 + map.yx * x_begin + map.yy * y_begin);
  cv::warpAffine(view(in, CV_8UC1), to, matrix, to.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT);
}

std::vector<int32_t> fixed_steps(const AffineMap& map, int width, int height) {
  constexpr int kOne = 1024, kHalfOf32nd = 16;
  std::vector<int32_t> steps;
  steps.reserve(size_t(2) * (width + height));
  for (int x = 0; x < width; ++x) {
    steps.push_back(cv::saturate_cast<int>(map.xx * x * kOne));
    steps.push_back(cv::saturate_cast<int>(map.yx * x * kOne));
  }
  for (int y = 0; y < height; ++y) {
    steps.push_back(cv::saturate_cast<int>((map.xy * y + map.x0) * kOne) + kHalfOf32nd);
    steps.push_back(cv::saturate_cast<int>((map.yy * y + map.y0) * kOne) + kHalfOf32nd);
  }
  return steps;
}

void shrink(const ImageRgb& in, int x_begin, int y_begin, int x_end, int y_end, int factor, ImageRgb& out) {
  if (x_begin < 0 || y_begin < 0 || x_end > in.width || y_end > in.height || factor < 1)
    throw LogicError("shrink: the rectangle is not inside the picture");
  if (in.pixels.size() != size_t(3) * in.width * in.height)
    throw LogicError("shrink: the pixels do not match the picture's size");
  out.width = std::max(0, (x_end - x_begin) / factor);
  out.height = std::max(0, (y_end - y_begin) / factor);
  out.pixels.resize(size_t(3) * out.width * out.height);
  if (out.empty()) return;
  const size_t pitch = size_t(3) * in.width;
  const int n = 3 * factor * out.width;
  std::vector<uint32_t> sums(n);
  for (int y = 0; y < out.height; ++y) {
    sum_rows(&in.pixels[(y_begin + size_t(y) * factor) * pitch + size_t(3) * x_begin], pitch, factor, n, sums.data());
    mean_of_blocks(sums.data(), factor, out.width, &out.pixels[size_t(3) * y * out.width]);
  }
}

}  // namespace livecap
