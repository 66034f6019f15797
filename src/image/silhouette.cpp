#include "image/silhouette.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Distances are measured between pixel centres; the contour runs half a pixel from the last centre of either side.
constexpr float kHalfPixel = 0.5f;

}  // namespace

Silhouette make_silhouette(const ImageGray& mask) {
  if (mask.width < 0 || mask.height < 0 || mask.pixels.size() != size_t(mask.width) * mask.height)
    throw LogicError(
        format("make_silhouette: %zu bytes for a %dx%d mask", mask.pixels.size(), mask.width, mask.height));
  Silhouette result;
  result.width = mask.width;
  result.height = mask.height;
  if (mask.empty()) return result;
  const cv::Mat gray(mask.height, mask.width, CV_8UC1, const_cast<uint8_t*>(mask.pixels.data()));
  cv::Mat inside, outside;
  cv::threshold(gray, inside, 127, 255, cv::THRESH_BINARY);
  result.area_px = cv::countNonZero(inside);
  if (result.empty()) return result;
  // A picture full of person has no contour: everything is as far inside as the picture is large.
  const float farthest = static_cast<float>(mask.width + mask.height);
  result.signed_distance.assign(mask.pixels.size(), -farthest);
  if (result.area_px == static_cast<int>(mask.pixels.size())) return result;

  cv::Mat distance(mask.height, mask.width, CV_32FC1, result.signed_distance.data());
  cv::bitwise_not(inside, outside);
  cv::distanceTransform(outside, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  // Inside needs only the person's box and the ring of background around it.
  cv::Rect box = cv::boundingRect(inside);
  box = (box + cv::Size(2, 2) - cv::Point(1, 1)) & cv::Rect(0, 0, mask.width, mask.height);
  cv::Mat depth;
  cv::distanceTransform(inside(box), depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  distance -= kHalfPixel;
  for (int y = 0; y < box.height; ++y) {
    float* row = distance.ptr<float>(box.y + y) + box.x;
    const float* depth_row = depth.ptr<float>(y);
    for (int x = 0; x < box.width; ++x) row[x] = depth_row[x] > 0 ? kHalfPixel - depth_row[x] : row[x];
  }
  return result;
}

}  // namespace livecap
