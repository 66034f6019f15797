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
  float doubt_darkest = 0.3f;    // with less, down to this share, it is in doubt where the network sees nobody

  void validate() const;  // throws ConfigError
};

// How a whole frame differs from the training pictures.
struct FrameChange {
  std::array<float, 3> gain = {1, 1, 1};  // brightness relative to the plate, per channel
  float sigma = 0;                        // noise that is left, 8-bit steps
  float changed = 0;                      // share of the pixels that differ by more than 25 steps all the same
};

class BackgroundModel {
 public:
  // One Gaussian of every pixel, as frames are compared with it: planes, so that the comparison runs on whole vectors.
  struct Layer {
    std::vector<float> mean[3];   // [w*h] each
    std::vector<float> variance;  // [w*h] as trained; 0 after one plate, which says nothing about noise
  };

  explicit BackgroundModel(const BackgroundOptions& options = {});

  // Adds one picture of the empty scene. All must have the same size (ConfigError).
  void train(const ImageRgb& plate);
  bool trained() const { return frames_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }

  // From the pixels that agree best with each other. ignore: the person, nonzero = not looked at, each of its pixels
  // for ignore_step x ignore_step of the frame's; may be empty.
  FrameChange estimate_change(const ImageRgb& frame, const ImageGray& ignore, int ignore_step) const;

  // The least variance to reckon with in such a frame.
  float least_variance(const FrameChange& change) const;

  // Of the empty scene: the heaviest means, rounded. Empty before it is trained.
  ImageRgb picture() const;

  const BackgroundOptions& options() const { return options_; }
  // Those Gaussians that are background; a pixel with fewer than others repeats its last. At least one once trained.
  const std::vector<Layer>& layers() const { return layers_; }
  // [w*h] what is added to every variance because edges move.
  const std::vector<float>& edge_variance() const { return edge_variance_; }

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
  std::vector<Gaussian> mixtures_;  // [kGaussians*w*h] heaviest first
  std::vector<Layer> layers_;
  std::vector<float> edge_variance_;
  std::vector<float> gain_means_;  // heaviest means where the gain is looked at, three per pixel
};

}  // namespace livecap
