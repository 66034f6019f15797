// What the empty scene looks like: at most three Gaussians per pixel, learned in the manner of Zivkovic and van der
// Heijden ("Efficient adaptive density estimation per image pixel for the task of background subtraction", 2006) and
// frozen afterwards, so that a person who stands still is not absorbed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/image_rgb.h"

namespace livecap {

struct BackgroundOptions {
  float initial_sigma = 6;       // standard deviation of a pixel seen once, in 8-bit steps; one plate has only this
  float min_sigma = 3;           // noise and compression leave at least this much
  float match_sigmas = 4;        // a pixel within this many deviations of a Gaussian belongs to it
  float edge_sigma = 0.12f;      // added deviation per 8-bit step of local contrast: edges move by fractions of a pixel
  float shadow_darkest = 0.55f;  // a shadow keeps at least this share of the brightness

  void validate() const;  // throws ConfigError
};

class BackgroundModel {
 public:
  explicit BackgroundModel(const BackgroundOptions& options = {});

  // Adds one picture of the empty scene. All must have the same size (ConfigError).
  void train(const ImageRgb& plate);
  bool trained() const { return frames_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }

  // Brightness of `frame` relative to the plate, per channel, from the pixels that agree best with each other.
  // ignore: [w*h], nonzero = not looked at (the person); may be empty.
  std::array<float, 3> estimate_gain(const ImageRgb& frame, const std::vector<uint8_t>& ignore) const;

  // Distance of each pixel in [x0, x1) x [y0, y1) from the background, 8-bit: 0 = background, 128 = at the matching
  // threshold, 255 = twice as far or more; shadow[]: the same with shadows taken for background. Both
  // [(x1-x0)*(y1-y0)].
  void distance(const ImageRgb& frame, const std::array<float, 3>& gain, int x0, int y0, int x1, int y1,
                std::vector<uint8_t>& plain, std::vector<uint8_t>& shadow) const;

 private:
  static constexpr int kGaussians = 3;
  struct Gaussian {
    float mean[3];
    float variance;
    float weight;  // 0 = unused
  };

  void learn(Gaussian* mixture, const uint8_t* pixel, float rate) const;
  void finish_training();

  BackgroundOptions options_;
  int width_ = 0;
  int height_ = 0;
  int frames_ = 0;
  std::vector<Gaussian> mixtures_;    // [kGaussians*w*h] heaviest first
  std::vector<float> edge_variance_;  // [w*h]
};

}  // namespace livecap
