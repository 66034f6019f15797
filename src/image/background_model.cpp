#include "image/background_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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
constexpr int kGainMinPixels = 200;
constexpr float kChangedSteps = 25;  // more than noise, compression and edges that move by a pixel mostly make
constexpr float kGainLimit = 0.35f;  // more than this is not drift but another scene

float squared(float x) {
  return x * x;
}

// What the middle half of some numbers is like.
struct MiddleHalf {
  float mean, lowest, highest;
};

// Sorts into bins of equal width, so that only the two bins at the quartiles are looked at closer: all numbers are in
// [0, kBins / kBinsPerUnit) or share the last bin. So narrow that few share one also in a picture without noise. Sums
// in double of so few floats are exact, in any order.
constexpr int kBins = 8192, kBinsPerUnit = 4096;

MiddleHalf middle_half(const float* values, int n) {
  const auto bin_of = [](float value) { return std::min(static_cast<int>(value * kBinsPerUnit), kBins - 1); };
  int count[kBins] = {};
  double sums[kBins] = {};
  for (int i = 0; i < n; ++i) {
    const int bin = bin_of(values[i]);
    ++count[bin];
    sums[bin] += values[i];
  }
  const int quarter = n / 4;
  const auto bin_with = [&](int rank) {
    int bin = 0, before = 0;
    while (before + count[bin] <= rank) before += count[bin++];
    return std::pair{bin, before};
  };
  const auto [low_bin, before_low] = bin_with(quarter);
  const auto [high_bin, before_high] = bin_with(n - quarter - 1);
  double sum = 0;
  for (int bin = low_bin + 1; bin < high_bin; ++bin) sum += sums[bin];
  std::vector<float> low, high;
  for (int i = 0; i < n; ++i) {
    const int bin = bin_of(values[i]);
    if (bin == low_bin) low.push_back(values[i]);
    if (bin == high_bin) high.push_back(values[i]);
  }
  const int first = quarter - before_low, last = n - quarter - 1 - before_high;
  std::nth_element(high.begin(), high.begin() + last, high.end());
  const float highest = high[last];
  high.resize(last + 1);
  if (low_bin == high_bin) low.swap(high);
  std::nth_element(low.begin(), low.begin() + first, low.end());
  sum = std::accumulate(low.begin() + first, low.end(), sum);
  if (low_bin != high_bin) sum = std::accumulate(high.begin(), high.end(), sum);
  return {static_cast<float>(sum / (n - 2 * quarter)), low[first], highest};
}

// Calls f(pixel, mean) for every pixel that is looked at. means: of these pixels, row by row.
template <typename F>
void for_each_sample(const ImageRgb& frame, const std::vector<float>& means, const ImageGray& ignore, int ignore_step,
                     F&& f) {
  const float* mean = means.data();
  for (int y = 0; y < frame.height; y += kGainStep) {
    const uint8_t* ignored = ignore.empty() ? nullptr : &ignore.pixels[size_t(y / ignore_step) * ignore.width];
    for (int x = 0; x < frame.width; x += kGainStep, mean += 3) {
      if (ignored && ignored[x / ignore_step]) continue;
      f(&frame.pixels[3 * (size_t(y) * frame.width + x)], mean);
    }
  }
}

}  // namespace

void BackgroundOptions::validate() const {
  if (!(initial_sigma > 0) || !(min_sigma > 0) || !(match_sigmas > 0) || !(edge_sigma >= 0))
    throw ConfigError("background: deviations must be positive");
  if (!(shadow_darkest > 0 && shadow_darkest <= 1)) throw ConfigError("background: shadow_darkest must be in (0, 1]");
  if (!(doubt_darkest > 0 && doubt_darkest <= shadow_darkest))
    throw ConfigError("background: doubt_darkest must be above 0 and at most shadow_darkest");
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
  gain_means_.clear();
  for (int y = 0; y < height_; y += kGainStep) {
    for (int x = 0; x < width_; x += kGainStep) {
      for (const auto& mean : layers_[0].mean) gain_means_.push_back(mean[size_t(y) * width_ + x]);
    }
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
  const size_t most = gain_means_.size() / 3;  // per channel
  std::vector<float> ratios[3] = {std::vector<float>(most), std::vector<float>(most), std::vector<float>(most)};
  int n[3] = {};
  for_each_sample(frame, gain_means_, ignore, ignore_step, [&](const uint8_t* pixel, const float* mean) {
    for (int c = 0; c < 3; ++c) {
      // Written in any case and kept where it counts: no branch that cannot be foreseen.
      ratios[c][n[c]] = pixel[c] / mean[c];
      n[c] += mean[c] >= kGainDarkest && mean[c] <= kGainBrightest && pixel[c] >= kGainDarkest &&
              pixel[c] <= kGainBrightest;
    }
  });
  double squares = 0;
  size_t n_squares = 0;
  for (int c = 0; c < 3; ++c) {
    if (n[c] < kGainMinPixels) continue;
    // The mean of the middle half: as robust as the median and free of its 8-bit steps.
    const MiddleHalf middle = middle_half(ratios[c].data(), n[c]);
    if (std::abs(middle.mean - 1) < kGainLimit) change.gain[c] = middle.mean;
    // Half the middle half's width is 0.6745 deviations of a normal distribution; ratios are relative to about
    // mid-grey.
    const float spread = 0.5f * (middle.highest - middle.lowest) / 0.6745f;
    squares += squared(spread * kTypicalValue);
    ++n_squares;
  }
  if (n_squares > 0) change.sigma = static_cast<float>(std::sqrt(squares / static_cast<double>(n_squares)));
  int n_all = 0, n_changed = 0;
  for_each_sample(frame, gain_means_, ignore, ignore_step, [&](const uint8_t* pixel, const float* mean) {
    bool changed = false;
    for (int c = 0; c < 3; ++c) {
      // How bright what was white is in less light is not known.
      if (mean[c] > kGainBrightest && change.gain[c] < 1) continue;
      changed |= std::abs(pixel[c] - std::min(255.0f, change.gain[c] * mean[c])) > kChangedSteps;
    }
    ++n_all;
    n_changed += changed;
  });
  if (n_all > 0) change.changed = float(n_changed) / float(n_all);
  return change;
}

ImageRgb BackgroundModel::picture() const {
  if (!trained()) return {};
  ImageRgb picture{width_, height_, std::vector<uint8_t>(size_t(3) * width_ * height_)};
  for (size_t p = 0; p < size_t(width_) * height_; ++p)
    for (int c = 0; c < 3; ++c)
      picture.pixels[3 * p + c] = uint8_t(std::clamp(std::lround(layers_[0].mean[c][p]), 0L, 255L));
  return picture;
}

float BackgroundModel::least_variance(const FrameChange& change) const {
  return squared(std::clamp(change.sigma, options_.min_sigma, options_.initial_sigma));
}

}  // namespace livecap
