#include "image/background_model.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Gaussians that share this part of a pixel's weight are its background (Zivkovic's c_f).
constexpr float kBackgroundShare = 0.9f;
// Every n-th pixel in both directions is enough for a global gain.
constexpr int kGainStep = 6;
// Pixels outside this range are clipped or all noise and say nothing about the gain.
constexpr int kGainDarkest = 24, kGainBrightest = 235;
constexpr float kTypicalValue = 128;
constexpr size_t kGainMinPixels = 200;
constexpr float kGainLimit = 0.35f;  // more than this is not drift but another scene

float squared(float x) {
  return x * x;
}

}  // namespace

void BackgroundOptions::validate() const {
  if (!(initial_sigma > 0) || !(min_sigma > 0) || !(match_sigmas > 0) || !(edge_sigma >= 0))
    throw ConfigError("background: deviations must be positive");
  if (!(shadow_darkest > 0 && shadow_darkest <= 1)) throw ConfigError("background: shadow_darkest must be in (0, 1]");
}

BackgroundModel::BackgroundModel(const BackgroundOptions& options) : options_(options) {
  options_.validate();
}

void BackgroundModel::train(const ImageRgb& plate) {
  if (plate.empty() || plate.pixels.size() != size_t(3) * plate.width * plate.height)
    throw ConfigError("background: empty plate");
  if (frames_ == 0) {
    width_ = plate.width;
    height_ = plate.height;
    mixtures_.assign(size_t(kGaussians) * width_ * height_, Gaussian{});
    edge_variance_.assign(size_t(width_) * height_, 0);
  } else if (plate.width != width_ || plate.height != height_) {
    throw ConfigError(
        format("background: a plate of %dx%d after one of %dx%d", plate.width, plate.height, width_, height_));
  }
  ++frames_;
  // The mean over all frames; in Zivkovic's terms a learning rate of 1/t.
  const float rate = 1.0f / static_cast<float>(frames_);
  for (size_t p = 0; p < size_t(width_) * height_; ++p) learn(&mixtures_[kGaussians * p], &plate.pixels[3 * p], rate);
  finish_training();
}

void BackgroundModel::learn(Gaussian* mixture, const uint8_t* pixel, float rate) const {
  Gaussian* match = nullptr;
  for (int k = 0; k < kGaussians && mixture[k].weight > 0; ++k) {
    Gaussian& g = mixture[k];
    g.weight *= 1 - rate;
    const float distance =
        squared(pixel[0] - g.mean[0]) + squared(pixel[1] - g.mean[1]) + squared(pixel[2] - g.mean[2]);
    if (!match && distance < squared(options_.match_sigmas) * g.variance) match = &g;
  }
  if (!match) {
    match = mixture;
    while (match < mixture + kGaussians - 1 && match->weight > 0) ++match;  // a free one, else the lightest
    *match = {{float(pixel[0]), float(pixel[1]), float(pixel[2])}, squared(options_.initial_sigma), rate};
  } else {
    match->weight += rate;
    const float step = rate / match->weight;
    float distance = 0;
    for (int c = 0; c < 3; ++c) {
      const float d = pixel[c] - match->mean[c];
      match->mean[c] += step * d;
      distance += d * d;
    }
    match->variance = std::max(match->variance + step * (distance / 3 - match->variance), squared(options_.min_sigma));
  }
  for (; match > mixture && match->weight > match[-1].weight; --match) std::swap(match[0], match[-1]);
}

void BackgroundModel::finish_training() {
  // Local contrast of the heaviest means: the largest step to a neighbour in any channel.
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const size_t p = size_t(y) * width_ + x;
      float contrast = 0;
      auto compare = [&](size_t q) {
        for (int c = 0; c < 3; ++c)
          contrast =
              std::max(contrast, std::abs(mixtures_[kGaussians * p].mean[c] - mixtures_[kGaussians * q].mean[c]));
      };
      if (x > 0) compare(p - 1);
      if (x + 1 < width_) compare(p + 1);
      if (y > 0) compare(p - width_);
      if (y + 1 < height_) compare(p + width_);
      edge_variance_[p] = squared(options_.edge_sigma * contrast);
    }
  }
}

FrameChange BackgroundModel::estimate_change(const ImageRgb& frame, const std::vector<uint8_t>& ignore) const {
  FrameChange change;
  std::vector<float> ratios;
  double squares = 0;
  size_t n_squares = 0;
  for (int c = 0; c < 3; ++c) {
    ratios.clear();
    for (int y = 0; y < height_; y += kGainStep) {
      for (int x = 0; x < width_; x += kGainStep) {
        const size_t p = size_t(y) * width_ + x;
        if (!ignore.empty() && ignore[p]) continue;
        const float mean = mixtures_[kGaussians * p].mean[c];
        const uint8_t value = frame.pixels[3 * p + c];
        if (mean < kGainDarkest || mean > kGainBrightest || value < kGainDarkest || value > kGainBrightest) continue;
        ratios.push_back(value / mean);
      }
    }
    if (ratios.size() < kGainMinPixels) continue;
    // The mean of the middle half: as robust as the median and free of its 8-bit steps.
    const size_t quarter = ratios.size() / 4;
    std::nth_element(ratios.begin(), ratios.begin() + quarter, ratios.end());
    std::nth_element(ratios.begin() + quarter, ratios.end() - quarter, ratios.end());
    double sum = 0;
    for (size_t i = quarter; i < ratios.size() - quarter; ++i) sum += ratios[i];
    const float mean = static_cast<float>(sum / static_cast<double>(ratios.size() - 2 * quarter));
    if (std::abs(mean - 1) < kGainLimit) change.gain[c] = mean;
    // Half the middle half's width is 0.6745 deviations of a normal distribution; ratios are relative to about
    // mid-grey.
    const float spread = 0.5f * (ratios[ratios.size() - quarter - 1] - ratios[quarter]) / 0.6745f;
    squares += squared(spread * kTypicalValue);
    ++n_squares;
  }
  if (n_squares > 0) change.sigma = static_cast<float>(std::sqrt(squares / static_cast<double>(n_squares)));
  return change;
}

BackgroundDistance BackgroundModel::distance(const ImageRgb& frame, const FrameChange& change, int x0, int y0, int x1,
                                             int y1) const {
  const size_t n = size_t(std::max(0, x1 - x0)) * std::max(0, y1 - y0);
  BackgroundDistance result;
  result.plain.resize(n);
  result.shadow.resize(n);
  result.contrast.resize(n);
  const float at_threshold = 128 / squared(options_.match_sigmas);
  const float inverse[3] = {1 / change.gain[0], 1 / change.gain[1], 1 / change.gain[2]};
  const float least_variance = squared(std::clamp(change.sigma, options_.min_sigma, options_.initial_sigma));
  size_t out = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x, ++out) {
      const size_t p = size_t(y) * width_ + x;
      const uint8_t* pixel = &frame.pixels[3 * p];
      const float value[3] = {pixel[0] * inverse[0], pixel[1] * inverse[1], pixel[2] * inverse[2]};
      float nearest = 1e9f, nearest_shadow = 1e9f, difference = 1e9f, share = 0;
      const Gaussian* end = &mixtures_[kGaussians * p] + kGaussians;
      for (const Gaussian* g = end - kGaussians; g < end && share < kBackgroundShare && g->weight > 0; ++g) {
        share += g->weight;
        // One plate says nothing about noise: then the frame's own counts.
        const float variance = std::max(frames_ > 1 ? g->variance : 0, least_variance) + edge_variance_[p];
        const float* m = g->mean;
        const float squares = squared(value[0] - m[0]) + squared(value[1] - m[1]) + squared(value[2] - m[2]);
        difference = std::min(difference, squares);
        nearest = std::min(nearest, squares / variance);
        // A shadow is the background darkened by one factor in all channels.
        const float factor =
            (value[0] * m[0] + value[1] * m[1] + value[2] * m[2] + 1) / (m[0] * m[0] + m[1] * m[1] + m[2] * m[2] + 1);
        if (factor < options_.shadow_darkest || factor > 1) continue;
        const float colour =
            squared(value[0] - factor * m[0]) + squared(value[1] - factor * m[1]) + squared(value[2] - factor * m[2]);
        nearest_shadow = std::min(nearest_shadow, colour / variance);
      }
      const float scaled = std::min(255.f, at_threshold * nearest);
      result.plain[out] = static_cast<uint8_t>(scaled);
      result.shadow[out] = static_cast<uint8_t>(std::min(scaled, at_threshold * nearest_shadow));
      result.contrast[out] = static_cast<uint8_t>(std::min(255.f, 0.5f * std::sqrt(difference)));
    }
  }
  return result;
}

}  // namespace livecap
