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

constexpr float kFar = 1e9f;

float squared(float x) {
  return x * x;
}

// Three planes of one row.
struct Row {
  const float* red;
  const float* green;
  const float* blue;
};

struct Nearest {
  float* difference;  // squared, not divided by a variance
  float* plain;       // squared, in deviations
  float* shadow;      // the same with shadows taken for background
};

// Takes one Gaussian of each pixel into the minima over all of them. None of the rows overlap.
void compare_row(const Row& value, const Row& mean, const float* trained_variance, const float* edge_variance,
                 float least_variance, float shadow_darkest, int n, const Nearest& nearest) {
  const auto [r, g, b] = value;
  const auto [mr, mg, mb] = mean;
#pragma GCC ivdep
  for (int x = 0; x < n; ++x) {
    const float variance = std::max(trained_variance[x], least_variance) + edge_variance[x];
    const float squares = squared(r[x] - mr[x]) + squared(g[x] - mg[x]) + squared(b[x] - mb[x]);
    nearest.difference[x] = std::min(nearest.difference[x], squares);
    nearest.plain[x] = std::min(nearest.plain[x], squares / variance);
    // A shadow is the background darkened by one factor in all channels.
    const float factor =
        (r[x] * mr[x] + g[x] * mg[x] + b[x] * mb[x] + 1) / (mr[x] * mr[x] + mg[x] * mg[x] + mb[x] * mb[x] + 1);
    const float colour =
        squared(r[x] - factor * mr[x]) + squared(g[x] - factor * mg[x]) + squared(b[x] - factor * mb[x]);
    const float in_shadow = (factor < shadow_darkest) | (factor > 1) ? kFar : colour / variance;
    nearest.shadow[x] = std::min({nearest.shadow[x], nearest.plain[x], in_shadow});
  }
}

void quantize(const float* __restrict value, float scale, int n, uint8_t* __restrict out) {
  for (int x = 0; x < n; ++x) out[x] = static_cast<uint8_t>(static_cast<int>(std::min(255.f, scale * value[x])));
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
  const size_t n = size_t(width_) * height_;
  layers_.clear();
  for (int k = 0; k < kGaussians; ++k) {
    Layer layer;
    for (auto& mean : layer.mean) mean.resize(n);
    layer.variance.resize(n);
    bool any = false;
    for (size_t p = 0; p < n; ++p) {
      const Gaussian* mixture = &mixtures_[kGaussians * p];
      float share = 0;
      int last = 0;
      for (; last < k && (share += mixture[last].weight) < kBackgroundShare && mixture[last + 1].weight > 0; ++last) {
      }
      any |= last == k;
      for (int c = 0; c < 3; ++c) layer.mean[c][p] = mixture[last].mean[c];
      layer.variance[p] = frames_ > 1 ? mixture[last].variance : 0;
    }
    if (!any) break;
    layers_.push_back(std::move(layer));
  }
  // Local contrast of the heaviest means: the largest step to a neighbour in any channel.
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const size_t p = size_t(y) * width_ + x;
      float contrast = 0;
      auto compare = [&](size_t q) {
        for (int c = 0; c < 3; ++c)
          contrast = std::max(contrast, std::abs(layers_[0].mean[c][p] - layers_[0].mean[c][q]));
      };
      if (x > 0) compare(p - 1);
      if (x + 1 < width_) compare(p + 1);
      if (y > 0) compare(p - width_);
      if (y + 1 < height_) compare(p + width_);
      edge_variance_[p] = squared(options_.edge_sigma * contrast);
    }
  }
}

FrameChange BackgroundModel::estimate_change(const ImageRgb& frame, const ImageGray& ignore, int ignore_step) const {
  FrameChange change;
  std::vector<float> ratios;
  double squares = 0;
  size_t n_squares = 0;
  for (int c = 0; c < 3; ++c) {
    ratios.clear();
    for (int y = 0; y < height_; y += kGainStep) {
      for (int x = 0; x < width_; x += kGainStep) {
        const size_t p = size_t(y) * width_ + x;
        if (!ignore.empty() && ignore.pixels[size_t(y / ignore_step) * ignore.width + x / ignore_step]) continue;
        const float mean = layers_[0].mean[c][p];
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
  const int width = std::max(0, x1 - x0);
  BackgroundDistance result;
  result.plain.resize(size_t(width) * std::max(0, y1 - y0));
  result.shadow.resize(result.plain.size());
  result.contrast.resize(result.plain.size());
  const float least_variance = squared(std::clamp(change.sigma, options_.min_sigma, options_.initial_sigma));
  float level[3][256];  // an 8-bit value as it would be in the plate's light
  for (int c = 0; c < 3; ++c) {
    for (int v = 0; v < 256; ++v) level[c][v] = static_cast<float>(v) * (1 / change.gain[c]);
  }
  std::vector<float> red(width), green(width), blue(width), nearest(width), nearest_shadow(width), difference(width);
  for (int y = y0; y < y1; ++y) {
    const size_t begin = size_t(y) * width_ + x0;
    const uint8_t* pixel = &frame.pixels[3 * begin];
    for (int x = 0; x < width; ++x) {
      red[x] = level[0][pixel[3 * x]];
      green[x] = level[1][pixel[3 * x + 1]];
      blue[x] = level[2][pixel[3 * x + 2]];
    }
    std::fill(nearest.begin(), nearest.end(), kFar);
    std::fill(nearest_shadow.begin(), nearest_shadow.end(), kFar);
    std::fill(difference.begin(), difference.end(), kFar);
    for (const Layer& layer : layers_)
      compare_row({red.data(), green.data(), blue.data()},
                  {&layer.mean[0][begin], &layer.mean[1][begin], &layer.mean[2][begin]}, &layer.variance[begin],
                  &edge_variance_[begin], least_variance, options_.shadow_darkest, width,
                  {difference.data(), nearest.data(), nearest_shadow.data()});
    const float at_threshold = 128 / squared(options_.match_sigmas);
    const size_t out = size_t(y - y0) * width;
    quantize(nearest.data(), at_threshold, width, &result.plain[out]);
    quantize(nearest_shadow.data(), at_threshold, width, &result.shadow[out]);
    for (float& d : difference) d = std::sqrt(d);
    quantize(difference.data(), 0.5f, width, &result.contrast[out]);
  }
  return result;
}

}  // namespace livecap
