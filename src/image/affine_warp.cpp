#include "image/affine_warp.h"

#include <opencv2/imgproc.hpp>

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
  out.width = std::max(0, (x_end - x_begin) / factor);
  out.height = std::max(0, (y_end - y_begin) / factor);
  out.pixels.resize(size_t(3) * out.width * out.height);
  if (out.empty()) return;
  const cv::Rect blocks(x_begin, y_begin, out.width * factor, out.height * factor);
  cv::Mat to = view(out, CV_8UC3);
  cv::resize(view(in, CV_8UC3)(blocks), to, to.size(), 0, 0, cv::INTER_AREA);
}

}  // namespace livecap
