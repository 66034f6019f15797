// The light that falls on bare skin; and its tint, which tells skin from what hides it.
#pragma once

#include <Eigen/Core>
#include <span>

#include "match/harmonic_light.h"

namespace livecap {

struct SkinLightOptions {
  HarmonicLightOptions harmonics;
  double off_tint = 0.2;  // what differs more from the skin's tint is none; on rendered skin 0.05 do

  void validate() const;  // throws ConfigError
};

// One visible vertex of skin.
struct SkinSample {
  int index = 0;                                     // among the vertices of skin
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, camera frame
  float brightness = 0;                              // linear light by albedo
  float area_px = 0;                                 // that it stands for; negative: not of the skin's colour
  Eigen::Vector2f tint = Eigen::Vector2f::Ones();    // red and blue by albedo, each by the brightness
};

class SkinLight {
 public:
  explicit SkinLight(const SkinLightOptions& options);  // throws ConfigError

  // The samples of a frame whose pose is believed. Those of another colour only count for the tint: it follows when a
  // camera changes its white balance. Most of them must be of skin.
  void learn(std::span<const SkinSample> all);

  const HarmonicLight& harmonics() const { return harmonics_; }
  // Median of the samples' tints, averaged over frames; ones before the first.
  const Eigen::Vector2d& tint() const { return tint_; }
  // How far from it, red or blue, something else begins; of no account before the first frame.
  double off_tint() const;

 private:
  void learn_tint(std::span<const SkinSample> samples);

  SkinLightOptions options_;
  HarmonicLight harmonics_;
  Eigen::Vector2d tint_ = Eigen::Vector2d::Ones();
  bool knows_tint_ = false;
};

}  // namespace livecap
