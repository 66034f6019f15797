#include "image/foreground.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "image/pieces.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr int kHalf = 128;
// Gate and core are made on a grid this much coarser: their borders are margins, not results.
constexpr int kCoarse = 4;
// A stranger's share beyond the gate, of what is looked at, is at least this.
constexpr double kShareBeyond = 0.1;
// A piece that touches less than this many pixels is noise whatever the largest one is.
constexpr int kMinPiecePx = 16;

cv::Mat disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1));
}

cv::Rect grown(const cv::Rect& box, int margin, const cv::Size& size) {
  return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
         cv::Rect({0, 0}, size);
}

// Drops pieces smaller than min_part of the largest, then closes holes smaller than max_hole of what is left.
void clean(cv::Mat& mask, float min_part, float max_hole) {
  const Pieces parts(mask, 255, true);
  int largest = 0;
  for (const Piece& part : parts.all()) largest = std::max(largest, part.area);
  const int smallest = std::max(kMinPiecePx, static_cast<int>(min_part * static_cast<float>(largest)));
  std::vector<bool> drop;
  int area = 0;
  for (const Piece& part : parts.all()) {
    drop.push_back(part.area < smallest);
    if (!drop.back()) area += part.area;
  }
  parts.paint(mask, drop, 0);

  const Pieces gaps(mask, 0, false);
  std::vector<bool> close;
  for (const Piece& gap : gaps.all())
    close.push_back(!gap.touches_border && static_cast<float>(gap.area) < max_hole * static_cast<float>(area));
  gaps.paint(mask, close, 255);
}

// Row y of a coarse picture, as wide as the box.
void spread(const cv::Mat& coarse, const cv::Rect& box, int y, std::vector<uint8_t>& row) {
  const uint8_t* from = coarse.ptr<uint8_t>(y / kCoarse);
  for (int x = 0; x < box.width; ++x) row[x] = from[(box.x + x) / kCoarse];
}

// What the network calls person is no shadow and needs less of a difference; nobody is outside the gate (coarse), and
// the core (coarse) is the person in any case. plain: [box] distances that take shadows for differences.
void trust_network(const cv::Mat& network, const cv::Mat& gate, const cv::Mat& core, const cv::Rect& box,
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
void drop_strangers(const cv::Mat& network, const cv::Mat& gate, const cv::Rect& box, int seam, float least_share,
                    const std::vector<uint8_t>& difference, cv::Mat& mask) {
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
  const Pieces pieces(others, 255, true);
  std::vector<bool> stranger;
  const std::vector<int> areas_beyond = pieces.areas_in(beyond);
  for (size_t i = 0; i < areas_beyond.size(); ++i)
    stranger.push_back(pieces.all()[i].area > least_area && areas_beyond[i] > kShareBeyond * pieces.all()[i].area);
  pieces.paint(mask, stranger, 0);
}

// A pixel that the person covers by less than half still differs from the background. Takes off border pixels whose
// contrast is less than `share` of the largest within two pixels.
void trim_border(cv::Mat& mask, const std::vector<uint8_t>& contrast, float share) {
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

}  // namespace

void ForegroundOptions::validate() const {
  background.validate();
  if (!(gate_margin >= 0 && gate_margin <= 1) || !(core_margin >= 0 && core_margin <= 1))
    throw ConfigError("foreground: margins must be in 0..1");
  if (!(core_probability > 0 && core_probability <= 1))
    throw ConfigError("foreground: core_probability must be in (0, 1]");
  if (!(seam >= 0 && seam <= 1) || !(stranger_reach >= 0 && stranger_reach <= 1) ||
      !(least_stranger >= 0 && least_stranger <= 1))
    throw ConfigError("foreground: seam, stranger_reach and least_stranger must be in 0..1");
  if (!(smooth_px >= 0 && smooth_px <= 10)) throw ConfigError("foreground: smooth_px must be in 0..10");
}

ForegroundModel::ForegroundModel(const ForegroundOptions& options)
    : options_(options), background_(options.background) {
  options_.validate();
}

ImageGray ForegroundModel::segment(const ImageRgb& frame, const PersonMask& network_mask) const {
  const cv::Size size(frame.width, frame.height);
  if (frame.pixels.size() != size_t(3) * frame.width * frame.height) throw LogicError("foreground: malformed frame");
  if (has_background() && (background_.width() != frame.width || background_.height() != frame.height))
    throw ConfigError(format("background plate is %dx%d, the video %dx%d", background_.width(), background_.height(),
                             frame.width, frame.height));
  if (!network_mask.empty() && (network_mask.width != frame.width || network_mask.height != frame.height))
    throw ConfigError(format("network mask is %dx%d, the video %dx%d", network_mask.width, network_mask.height,
                             frame.width, frame.height));
  ImageGray result{frame.width, frame.height, std::vector<uint8_t>(size_t(frame.width) * frame.height, 0)};
  if (network_mask.empty() && !has_background()) return result;
  cv::Mat out(size, CV_8UC1, result.pixels.data());

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
    gate_radius = radius(options_.gate_margin);
    const auto height = static_cast<float>(kCoarse * person.height);
    seam = std::max(2, static_cast<int>(std::lround(options_.seam * height)));
    const int reach = std::max(kCoarse, static_cast<int>(std::lround(options_.stranger_reach * height)));
    cv::threshold(coarse, core, 255 * options_.core_probability, 255, cv::THRESH_BINARY);
    cv::dilate(gate, gate, disc(gate_radius));
    cv::erode(core, core, disc(radius(options_.core_margin)));
    person = cv::Rect(person.x * kCoarse, person.y * kCoarse, person.width * kCoarse, person.height * kCoarse);
    box = grown(person, gate_radius * kCoarse + reach, size);
  }

  BackgroundDistance distance;
  std::vector<uint8_t> difference;
  cv::Mat score;  // > 128: person
  if (!has_background()) {
    cv::GaussianBlur(probability(box), score, cv::Size(0, 0), std::max(0.5f, options_.smooth_px));
  } else {
    const ImageGray ignore{gate.cols, gate.rows, std::vector<uint8_t>(gate.datastart, gate.dataend)};
    const FrameChange change = background_.estimate_change(frame, ignore, kCoarse);
    distance = background_.distance(frame, change, box.x, box.y, box.x + box.width, box.y + box.height);
    difference = distance.shadow;
    score = cv::Mat(box.size(), CV_8UC1, distance.shadow.data());
    if (!probability.empty()) trust_network(probability(box), gate, core, box, distance.plain, options_.trust, score);
    if (options_.smooth_px > 0) cv::GaussianBlur(score, score, cv::Size(0, 0), options_.smooth_px);
  }
  cv::Mat mask;
  cv::threshold(score, mask, kHalf, 255, cv::THRESH_BINARY);
  if (has_background()) trim_border(mask, distance.contrast, options_.edge_share);
  if (has_background() && !probability.empty())
    drop_strangers(probability(box), gate, box, seam, options_.least_stranger, difference, mask);
  clean(mask, options_.min_part, options_.max_hole);
  mask.copyTo(out(box));
  return result;
}

}  // namespace livecap
