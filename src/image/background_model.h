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
  float initial_sigma = 6;       // standard deviation given to a newly learned Gaussian, in 8-bit steps
  float min_sigma = 2;           // noise and compression leave at least this much
  float match_sigmas = 5;        // a pixel within this many deviations of a Gaussian belongs to it
  float edge_sigma = 0.12f;      // added deviation per 8-bit step of local contrast: edges move by fractions of a pixel
  float shadow_darkest = 0.55f;  // a shadow keeps at least this share of the brightness

  void validate() const;  // throws ConfigError
};

// How a whole frame differs from the training pictures.
struct FrameChange {
  std::array<float, 3> gain = {1, 1, 1};  // brightness relative to the plate, per channel
  float sigma = 0;                        // noise that is left, 8-bit steps
};

// Distances of the pixels of a box from the background, row major, 8-bit.
struct BackgroundDistance {
  std::vector<uint8_t> plain;     // 0 = background, 128 = at the matching threshold, 255 = twice its square or more
  std::vector<uint8_t> shadow;    // the same with shadows taken for background
  std::vector<uint8_t> contrast;  // colour difference, Euclidean, divided by 2
};

class BackgroundModel {
 public:
  explicit BackgroundModel(const BackgroundOptions& options = {});

  // Adds one picture of the empty scene. All must have the same size (ConfigError).
  void train(const ImageRgb& plate);
  bool trained() const { return frames_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }

  // From the pixels that agree best with each other. ignore: the person, nonzero = not looked at, each of its pixels
  // for ignore_step x ignore_step of the frame's; may be empty.
  FrameChange estimate_change(const ImageRgb& frame, const ImageGray& ignore, int ignore_step) const;

  // Over the pixels of [x0, x1) x [y0, y1).
  BackgroundDistance distance(const ImageRgb& frame, const FrameChange& change, int x0, int y0, int x1, int y1) const;

 private:
  static constexpr int kGaussians = 3;
  struct Gaussian {
    float mean[3];
    float variance;
    float weight;  // 0 = unused
  };
  // One Gaussian of every pixel, as frames are compared with it: planes, so that the comparison runs on whole vectors.
  struct Layer {
    std::vector<float> mean[3];   // [w*h] each
    std::vector<float> variance;  // [w*h] as trained; 0 after one plate, which says nothing about noise
  };

  void learn(Gaussian* mixture, const uint8_t* pixel, float rate) const;
  void finish_training();

  BackgroundOptions options_;
  int width_ = 0;
  int height_ = 0;
  int frames_ = 0;
  std::vector<Gaussian> mixtures_;  // [kGaussians*w*h] heaviest first
  // Those that are background; a pixel with fewer than others repeats its last. At least one once trained.
  std::vector<Layer> layers_;
  std::vector<float> edge_variance_;  // [w*h]
};

}  // namespace livecap
