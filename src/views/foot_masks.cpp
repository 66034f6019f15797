#include "views/foot_masks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

namespace livecap {

namespace {

// Shares of the person's height in the picture.
constexpr double kFeet = 0.12;        // so much of the mask are feet and what is above them
constexpr double kSoles = 0.03;       // that the mask may have lost
constexpr double kNearby = 0.04;      // no foot is farther from the mask
constexpr double kShading = 0.005;    // of a shadow: what is so far apart is as dark, standard deviation
constexpr double kNotFloor = 0.0034;  // so near to the person a pixel may be theirs in part

constexpr float kGrey = 110;      // of a floor divided by itself
constexpr float kDarkest = 16;    // of the empty scene: less tells nothing when it divides
constexpr float kBrighter = 4;    // standard deviation of a floor's brightness above what is beside it, of 255,
constexpr float kDarker = 12;     // below: shadows are darkest where a shoe stands,
constexpr float kColor = 3;       // and of its colour
constexpr float kFoot = 1.5;      // what it costs to call a pixel a foot's; the floor's, half its deviations squared,
constexpr float kMostFloor = 12;  // but no more
constexpr float kEdgeCost = 12;   // what it costs when neighbours differ, where they look the same,
constexpr float kContrast = 12;   // which falls with what they differ by, of 255
constexpr int kCuts = 4;

using Graph = cv::detail::GCGraph<float>;

cv::Mat disc(double radius) {
  const int r = std::max(1, static_cast<int>(std::lround(radius)));
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1});
}

// How dark the floor is everywhere, from where it is seen; grey: the picture's brightness.
cv::Mat_<float> shading(const cv::Mat_<float>& grey, const cv::Mat_<float>& floor, double sigma) {
  cv::Mat_<float> sum = cv::Mat_<float>::zeros(grey.size()), weight = sum.clone();
  const cv::Mat_<float> seen = grey.mul(floor);
  float share = 1;
  for (const double wider : {1.0, 3.0, 9.0}) {  // where nothing is near, what is farther
    cv::Mat_<float> blurred;
    cv::GaussianBlur(seen, blurred, {}, wider * sigma);
    sum += share * blurred;
    cv::GaussianBlur(floor, blurred, {}, wider * sigma);
    weight += share * blurred;
    share *= 1e-3f;
  }
  return sum / cv::max(weight, 1e-12f);
}

float floor_cost(const cv::Vec3f& pixel) {
  const cv::Vec3f off = pixel - cv::Vec3f::all(kGrey);
  const float brightness = (off[0] + off[1] + off[2]) / 3;
  const cv::Vec3f color = off - cv::Vec3f::all(brightness);
  const float in_brightness = brightness / (brightness > 0 ? kBrighter : kDarker);
  return std::min(kMostFloor, (in_brightness * in_brightness + color.dot(color) / (kColor * kColor)) / 2);
}

// [h*w] 255 = foot. even: the picture, divided by the floor; fixed: 1 = no foot, 2 = foot, 0 = not known.
cv::Mat_<uint8_t> minimum_cut(const cv::Mat_<cv::Vec3f>& even, const cv::Mat_<uint8_t>& fixed) {
  constexpr float kSure = 1e4f;
  constexpr std::array<std::array<int, 2>, 4> kNeighbors = {{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};  // x, y
  Graph graph(static_cast<unsigned>(even.total()), static_cast<unsigned>(8 * even.total()));
  for (int y = 0; y < even.rows; ++y)
    for (int x = 0; x < even.cols; ++x) {
      const int p = graph.addVtx();
      const float as_floor = fixed(y, x) == 2 ? kSure : fixed(y, x) == 1 ? 0 : floor_cost(even(y, x));
      graph.addTermWeights(p, as_floor, fixed(y, x) == 1 ? kSure : kFoot);
    }
  for (int y = 0; y < even.rows; ++y)
    for (int x = 0; x < even.cols; ++x)
      for (const auto& [dx, dy] : kNeighbors) {
        if (x + dx < 0 || x + dx >= even.cols || y + dy >= even.rows) continue;
        const cv::Vec3f apart = even(y, x) - even(y + dy, x + dx);
        const float cost = kEdgeCost * std::exp(-apart.dot(apart) / (2 * kContrast * kContrast)) /
                           std::sqrt(static_cast<float>(dx * dx + dy * dy));
        graph.addEdges(y * even.cols + x, (y + dy) * even.cols + x + dx, cost, cost);
      }
  graph.maxFlow();
  cv::Mat_<uint8_t> foot(even.size());
  for (int p = 0; p < static_cast<int>(foot.total()); ++p)
    foot(p / even.cols, p % even.cols) = graph.inSourceSegment(p) ? 255 : 0;
  return foot;
}

}  // namespace

void cut_feet_from_shadows(const ImageRgb& plate, const ImageGray& known, const ImageRgb& image, ImageGray& mask) {
  const cv::Size size(mask.width, mask.height);
  cv::Mat whole(size, CV_8UC1, mask.pixels.data());
  const cv::Rect person = cv::boundingRect(whole > 127);
  if (person.empty()) return;
  const double height = person.height;
  const int top = static_cast<int>(person.br().y - kFeet * height);
  const int bottom = std::min(size.height, static_cast<int>(person.br().y + kSoles * height));
  const cv::Rect lowest = cv::boundingRect(whole(cv::Rect(0, top, size.width, person.br().y - top)) > 127);
  const int nearby = static_cast<int>(std::ceil(kNearby * height));
  const cv::Rect box = cv::Rect(lowest.x - nearby, top, lowest.width + 2 * nearby, bottom - top) & cv::Rect({}, size);

  cv::Mat_<cv::Vec3f> ratio, empty;
  cv::Mat(size, CV_8UC3, const_cast<uint8_t*>(image.pixels.data()))(box).convertTo(ratio, CV_32FC3, kGrey);
  cv::Mat(size, CV_8UC3, const_cast<uint8_t*>(plate.pixels.data()))(box).convertTo(empty, CV_32FC3);
  ratio = cv::min(ratio / cv::max(empty, kDarkest), 255);
  cv::Mat_<float> grey;
  cv::transform(ratio, grey, cv::Matx13f(1 / 3.f, 1 / 3.f, 1 / 3.f));

  cv::Mat_<uint8_t> feet = whole(box) > 127, near, fixed(box.size(), uint8_t(0));
  cv::dilate(feet, near, disc(nearby));
  fixed.setTo(1, near == 0);
  fixed.setTo(2, feet & (cv::Mat(size, CV_8UC1, const_cast<uint8_t*>(known.pixels.data()))(box) == 0));
  for (int round = 0; round < kCuts; ++round) {
    cv::Mat_<uint8_t> about;
    cv::dilate(feet, about, disc(kNotFloor * height));
    cv::Mat_<float> floor;
    cv::Mat(about == 0).convertTo(floor, CV_32F, 1 / 255.0);
    const cv::Mat_<float> dark = shading(grey, floor, kShading * height);
    cv::Mat_<cv::Vec3f> even = ratio.clone();
    for (int y = 0; y < even.rows; ++y)
      for (int x = 0; x < even.cols; ++x)
        for (int c = 0; c < 3; ++c) even(y, x)[c] = std::min(255.f, even(y, x)[c] * kGrey / std::max(dark(y, x), 5.f));
    feet = minimum_cut(even, fixed);
  }
  feet.copyTo(whole(box));
}

}  // namespace livecap
