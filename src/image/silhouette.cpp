#include "image/silhouette.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "image/distance_field.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// A model further out than this has been lost; there it only matters which way is back.
constexpr int kSmallestMarginPx = 32;
constexpr int kMarginShare = 8;  // of the longer side of the person's box: one part in this many

// Fills everything outside `box` from the distances on its border.
void extend_outwards(cv::Mat& distance, const cv::Rect& box) {
  const int right = box.x + box.width - 1, bottom = box.y + box.height - 1;
  for (int y = 0; y < distance.rows; ++y) {
    float* row = distance.ptr<float>(y);
    const int from_y = std::clamp(y, box.y, bottom);
    const float* from = distance.ptr<float>(from_y);
    const float dy = static_cast<float>(y - from_y);
    if (dy != 0) {
      for (int x = box.x; x <= right; ++x) row[x] = from[x] + std::abs(dy);
    }
    const auto beside = [&](int begin, int end, int from_x) {
      const float value = from[from_x];
      for (int x = begin; x < end; ++x) {
        const float dx = static_cast<float>(x - from_x);
        row[x] = value + std::sqrt(dx * dx + dy * dy);
      }
    };
    beside(0, box.x, box.x);
    beside(right + 1, distance.cols, right);
  }
}

}  // namespace

int silhouette_margin_px(int box_width, int box_height) {
  return std::max(kSmallestMarginPx, std::max(box_width, box_height) / kMarginShare);
}

Silhouette make_silhouette(const ImageGray& mask) {
  if (mask.width < 0 || mask.height < 0 || mask.pixels.size() != size_t(mask.width) * mask.height)
    throw LogicError(
        format("make_silhouette: %zu bytes for a %dx%d mask", mask.pixels.size(), mask.width, mask.height));
  Silhouette result;
  result.width = mask.width;
  result.height = mask.height;
  if (mask.empty()) return result;
  const cv::Mat gray(mask.height, mask.width, CV_8UC1, const_cast<uint8_t*>(mask.pixels.data()));
  cv::Mat inside;
  cv::threshold(gray, inside, 127, 255, cv::THRESH_BINARY);
  result.area_px = cv::countNonZero(inside);
  if (result.empty()) return result;
  result.box = bounding_box(ImageGray{mask.width, mask.height, {inside.datastart, inside.dataend}});
  // A picture full of person has no contour: everything is as far inside as the picture is large.
  const float farthest = static_cast<float>(mask.width + mask.height);
  result.signed_distance.assign(mask.pixels.size(), -farthest);
  if (result.area_px == static_cast<int>(mask.pixels.size())) return result;

  cv::Mat distance(mask.height, mask.width, CV_32FC1, result.signed_distance.data());
  const cv::Rect picture(0, 0, mask.width, mask.height);
  const auto grown = [&](const cv::Rect& box, int margin) {
    return (box + cv::Size(2 * margin, 2 * margin) - cv::Point(margin, margin)) & picture;
  };
  const cv::Rect person = cv::boundingRect(inside);
  const cv::Rect exact = grown(person, silhouette_margin_px(person.width, person.height));
  cv::Mat distance_exact = distance(exact);
  signed_distance(inside(exact), distance_exact);
  extend_outwards(distance, exact);
  return result;
}

double distance_at(const Silhouette& s, double x, double y) {
  const double in_x = std::clamp(x, 0.0, s.width - 1.001), in_y = std::clamp(y, 0.0, s.height - 1.001);
  const int ix = static_cast<int>(in_x), iy = static_cast<int>(in_y);
  const double fx = in_x - ix, fy = in_y - iy, dx = x - in_x, dy = y - in_y;
  const float* d = &s.signed_distance[static_cast<size_t>(iy) * s.width + ix];
  return (1 - fy) * ((1 - fx) * d[0] + fx * d[1]) + fy * ((1 - fx) * d[s.width] + fx * d[s.width + 1]) +
         std::sqrt(dx * dx + dy * dy);
}

}  // namespace livecap
