// The person's mask in plain C++ and OpenCV, as kernels/image/foreground.cl is checked against: the same decisions
// pixel by pixel, connected pieces by OpenCV.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "image/foreground.h"

namespace livecap::test {

constexpr int kHalf = 128;
constexpr int kCoarse = 4;
constexpr double kShareBeyond = 0.1;
constexpr int kMinPiecePx = 16;

struct ReferenceDistance {
  std::vector<uint8_t> plain, shadow, dark, contrast;
};

inline float squared(float x) {
  return x * x;
}

inline ReferenceDistance reference_distance(const BackgroundModel& model, const ImageRgb& frame,
                                            const FrameChange& change, const cv::Rect& box) {
  ReferenceDistance result;
  const float least_variance =
      squared(std::clamp(change.sigma, model.options().min_sigma, model.options().initial_sigma));
  const auto byte = [](float value) { return static_cast<uint8_t>(static_cast<int>(std::min(255.f, value))); };
  const float at_threshold = 128 / squared(model.options().match_sigmas);
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const size_t p = size_t(y) * frame.width + x;
      float v[3], difference = 1e9f, plain = 1e9f, shadow = 1e9f, dark = 1e9f;
      for (int c = 0; c < 3; ++c) v[c] = static_cast<float>(frame.pixels[3 * p + c]) / change.gain[c];
      for (const BackgroundModel::Layer& layer : model.layers()) {
        const float variance = std::max(layer.variance[p], least_variance) + model.edge_variance()[p];
        float squares = 0, along = 1, norm = 1, colour = 0;
        for (int c = 0; c < 3; ++c) {
          squares += squared(v[c] - layer.mean[c][p]);
          along += v[c] * layer.mean[c][p];
          norm += squared(layer.mean[c][p]);
        }
        const float factor = along / norm;
        for (int c = 0; c < 3; ++c) colour += squared(v[c] - factor * layer.mean[c][p]);
        difference = std::min(difference, squares);
        plain = std::min(plain, squares / variance);
        shadow = std::min(shadow, plain);
        if (factor >= model.options().shadow_darkest && factor <= 1) shadow = std::min(shadow, colour / variance);
        if (factor >= model.options().doubt_darkest && factor <= 1) dark = std::min(dark, colour / variance);
      }
      result.plain.push_back(byte(plain * at_threshold));
      result.shadow.push_back(byte(shadow * at_threshold));
      result.dark.push_back(byte(dark * at_threshold));
      result.contrast.push_back(byte(std::sqrt(difference) * 0.5f));
    }
  }
  return result;
}

inline cv::Rect grown_rect(const cv::Rect& box, int margin, const cv::Size& size) {
  return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
         cv::Rect({0, 0}, size);
}

inline cv::Mat disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1));
}

// Drops pieces smaller than min_part of the largest, then closes holes smaller than max_hole of what is left.
inline void clean(cv::Mat& mask, float min_part, float max_hole) {
  cv::Mat labels, stats, centers;
  const int n = cv::connectedComponentsWithStats(mask, labels, stats, centers, 8, CV_32S);
  int largest = 0, area = 0;
  for (int i = 1; i < n; ++i) largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
  const int smallest = std::max(kMinPiecePx, static_cast<int>(min_part * static_cast<float>(largest)));
  for (int i = 1; i < n; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) < smallest) {
      mask.setTo(0, labels == i);
    } else {
      area += stats.at<int>(i, cv::CC_STAT_AREA);
    }
  }
  const cv::Mat gaps = mask == 0;
  const int m = cv::connectedComponentsWithStats(gaps, labels, stats, centers, 4, CV_32S);
  for (int i = 1; i < m; ++i) {
    const int x = stats.at<int>(i, cv::CC_STAT_LEFT), y = stats.at<int>(i, cv::CC_STAT_TOP);
    const bool border = x == 0 || y == 0 || x + stats.at<int>(i, cv::CC_STAT_WIDTH) == mask.cols ||
                        y + stats.at<int>(i, cv::CC_STAT_HEIGHT) == mask.rows;
    if (!border && stats.at<int>(i, cv::CC_STAT_AREA) < max_hole * static_cast<float>(area))
      mask.setTo(255, labels == i);
  }
}

// Row y of a coarse picture, as wide as the box.
inline void spread(const cv::Mat& coarse, const cv::Rect& box, int y, std::vector<uint8_t>& row) {
  const uint8_t* from = coarse.ptr<uint8_t>(y / kCoarse);
  for (int x = 0; x < box.width; ++x) row[x] = from[(box.x + x) / kCoarse];
}

// What the network calls person is no shadow and needs less of a difference; nobody is outside the gate (coarse), and
// the core (coarse) is the person in any case. plain: [box] distances that take shadows for differences.
inline void trust_network(const cv::Mat& network, const cv::Mat& gate, const cv::Mat& core, const cv::Rect& box,
                          const std::vector<uint8_t>& plain, float trust, cv::Mat& score) {
  std::vector<uint8_t> gate_row(box.width), core_row(box.width);
  for (int y = 0; y < box.height; ++y) {
    if (y == 0 || (box.y + y) % kCoarse == 0) {
      spread(gate, box, box.y + y, gate_row);
      spread(core, box, box.y + y, core_row);
    }
    uint8_t* s = score.ptr<uint8_t>(y);
    const uint8_t* m = network.ptr<uint8_t>(y);
    const uint8_t* d = plain.data() + size_t(y) * box.width;
    const uint8_t *may_be = gate_row.data(), *is = core_row.data();
#pragma GCC ivdep
    for (int x = 0; x < box.width; ++x) {
      const int gain = 256 + static_cast<int>(static_cast<float>((m[x] - kHalf) * 2) * trust);  // in 1/256
      const int without = s[x], trusted = std::min(255, (d[x] * gain) >> 8);
      s[x] = static_cast<uint8_t>(((m[x] >= kHalf ? trusted : without) & may_be[x]) | is[x]);
    }
  }
}

// What the network does not call person and what goes on beyond the gate (coarse) is no part of the person that the
// network missed but somebody else, when it is large there. difference: [box] 128 or more = not the background. Nearer
// than `seam` pixels to the network's person it stays: the network's border is not exact enough to tell.
inline void drop_strangers(const cv::Mat& network, const cv::Mat& gate, const cv::Rect& box, int seam,
                           float least_share, const std::vector<uint8_t>& difference, cv::Mat& mask) {
  cv::Mat known, beyond(mask.size(), CV_8UC1);  // beyond: differs, outside the gate
  cv::threshold(network, known, kHalf - 1, 255, cv::THRESH_BINARY);
  const int least_area = static_cast<int>(least_share * static_cast<float>(cv::countNonZero(known)));
  std::vector<uint8_t> gate_row(mask.cols);
  for (int y = 0; y < mask.rows; ++y) {
    if (y == 0 || (box.y + y) % kCoarse == 0) spread(gate, box, box.y + y, gate_row);
    const uint8_t *in_gate = gate_row.data(), *d = difference.data() + size_t(y) * mask.cols;
    uint8_t* out = beyond.ptr<uint8_t>(y);
    for (int x = 0; x < mask.cols; ++x) out[x] = static_cast<uint8_t>((d[x] >= kHalf ? 255 : 0) & ~in_gate[x]);
  }
  if (cv::countNonZero(beyond) <= kShareBeyond * least_area) return;
  cv::dilate(known, known, disc(seam));
  const cv::Mat others = (mask | beyond) & ~known;
  cv::Mat labels, stats, centers;
  const int n = cv::connectedComponentsWithStats(others, labels, stats, centers, 8, CV_32S);
  for (int i = 1; i < n; ++i) {
    const cv::Mat piece = labels == i;
    const int area = stats.at<int>(i, cv::CC_STAT_AREA);
    if (area > least_area && cv::countNonZero(piece & beyond) > kShareBeyond * area) mask.setTo(0, piece);
  }
}

// A pixel that the person covers by less than half still differs from the background. Takes off border pixels whose
// contrast is less than `share` of the largest within two pixels.
inline void trim_border(cv::Mat& mask, const std::vector<uint8_t>& contrast, float share) {
  cv::Mat inner;
  cv::erode(mask, inner, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(3, 3)));
  constexpr int kReach = 2;
  for (int y = kReach; y < mask.rows - kReach; ++y) {
    uint8_t* row = mask.ptr<uint8_t>(y);
    const uint8_t* inner_row = inner.ptr<uint8_t>(y);
    for (int x = kReach; x < mask.cols - kReach; ++x) {
      if (!row[x] || inner_row[x]) continue;
      int largest = 0;
      for (int v = y - kReach; v <= y + kReach; ++v) {
        const uint8_t* from = contrast.data() + size_t(v) * mask.cols + x - kReach;
        largest = std::max<int>(largest, *std::max_element(from, from + 2 * kReach + 1));
      }
      if (static_cast<float>(contrast[size_t(y) * mask.cols + x]) < share * static_cast<float>(largest)) row[x] = 0;
    }
  }
}

// 255 where the network sees nobody and what differs may be a dark shadow.
inline cv::Mat doubt(const cv::Mat& network, const cv::Mat& gate, const cv::Rect& box,
                     const std::vector<uint8_t>& difference, const std::vector<uint8_t>& dark) {
  cv::Mat in_doubt = cv::Mat::zeros(box.size(), CV_8UC1);
  std::vector<uint8_t> gate_row(box.width);
  for (int y = 0; y < box.height; ++y) {
    spread(gate, box, box.y + y, gate_row);
    for (int x = 0; x < box.width; ++x) {
      const size_t p = size_t(y) * box.width + x;
      const bool differs = difference[p] >= kHalf && gate_row[x];
      if (differs && dark[p] < kHalf && network.at<uint8_t>(y, x) < kHalf) in_doubt.at<uint8_t>(y, x) = 255;
    }
  }
  return in_doubt;
}

struct ReferenceForeground {
  ImageGray mask, sure;
};

inline ReferenceForeground reference_foreground(const BackgroundModel& background, const ForegroundOptions& options,
                                                const ImageRgb& frame, const PersonMask& network_mask) {
  const cv::Size size(frame.width, frame.height);
  const ImageGray nobody{frame.width, frame.height, std::vector<uint8_t>(size_t(frame.width) * frame.height, 0)};
  ReferenceForeground result{nobody, nobody};
  if (network_mask.empty() && !background.trained()) return result;
  cv::Mat out(size, CV_8UC1, result.mask.pixels.data()), sure_out(size, CV_8UC1, result.sure.pixels.data());

  // Where the person may be (gate) and certainly is (core), coarse.
  cv::Mat probability, gate, core;
  cv::Rect box({0, 0}, size);
  int gate_radius = 0, seam = 0;
  if (!network_mask.empty()) {
    probability = cv::Mat(size, CV_8UC1, const_cast<uint8_t*>(network_mask.probability.data()));
    cv::Mat coarse;
    cv::resize(probability, coarse,
               cv::Size((size.width + kCoarse - 1) / kCoarse, (size.height + kCoarse - 1) / kCoarse), 0, 0,
               cv::INTER_AREA);
    cv::threshold(coarse, gate, kHalf - 1, 255, cv::THRESH_BINARY);
    cv::Rect person = cv::boundingRect(gate);
    if (person.empty()) return result;
    auto radius = [&](float margin) {
      return std::max(1, static_cast<int>(std::lround(margin * static_cast<float>(person.height))));
    };
    gate_radius = radius(options.gate_margin);
    const auto height = static_cast<float>(kCoarse * person.height);
    seam = std::max(2, static_cast<int>(std::lround(options.seam * height)));
    const int reach = std::max(kCoarse, static_cast<int>(std::lround(options.stranger_reach * height)));
    cv::threshold(coarse, core, 255 * options.core_probability, 255, cv::THRESH_BINARY);
    cv::dilate(gate, gate, disc(gate_radius));
    cv::erode(core, core, disc(radius(options.core_margin)));
    person = cv::Rect(person.x * kCoarse, person.y * kCoarse, person.width * kCoarse, person.height * kCoarse);
    box = grown_rect(person, gate_radius * kCoarse + reach, size);
  }

  ReferenceDistance distance;
  std::vector<uint8_t> difference;
  cv::Mat score;  // > 128: person
  if (!background.trained()) {
    cv::GaussianBlur(probability(box), score, cv::Size(0, 0), std::max(0.5f, options.smooth_px));
  } else {
    const ImageGray ignore{gate.cols, gate.rows, std::vector<uint8_t>(gate.datastart, gate.dataend)};
    const FrameChange change = background.estimate_change(frame, ignore, kCoarse);
    distance = reference_distance(background, frame, change, box);
    difference = distance.shadow;
    score = cv::Mat(box.size(), CV_8UC1, distance.shadow.data());
    if (!probability.empty()) trust_network(probability(box), gate, core, box, distance.plain, options.trust, score);
    if (options.smooth_px > 0) cv::GaussianBlur(score, score, cv::Size(0, 0), options.smooth_px);
  }
  cv::Mat mask;
  cv::threshold(score, mask, kHalf, 255, cv::THRESH_BINARY);
  if (background.trained()) trim_border(mask, distance.contrast, options.edge_share);
  if (background.trained() && !probability.empty())
    drop_strangers(probability(box), gate, box, seam, options.least_stranger, difference, mask);
  clean(mask, options.min_part, options.max_hole);
  mask.copyTo(out(box));
  if (background.trained() && !probability.empty()) {
    const cv::Mat in_doubt = doubt(probability(box), gate, box, difference, distance.dark);
    if (cv::countNonZero(in_doubt) > double(options.max_hole) * cv::countNonZero(mask)) {
      mask.setTo(0, in_doubt);
      clean(mask, options.min_part, options.max_hole);
    }
  }
  mask.copyTo(sure_out(box));
  return result;
}

}  // namespace livecap::test
