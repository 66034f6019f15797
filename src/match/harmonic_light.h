// The light that falls on surfaces, learned from the frames already solved: spherical harmonics of order 2 fitted to
// how bright the light is by what pictures show of them, robustly, older frames counting less.
#pragma once

#include <Eigen/Core>
#include <span>

#include "geometry/shaded_vertex.h"

namespace livecap {

struct HarmonicLightOptions {
  double memory_frames = 100;     // after so many a frame's say has fallen to 1/e
  double least_frames = 5;        // before the light is known
  double least_deviation = 0.03;  // of brightness; less is not believed
  double full_weight = 800;       // a frame whose samples weigh less counts less
  int least_samples = 20;         // a frame with fewer tells nothing

  void validate() const;  // throws ConfigError
};

struct LightSample {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, camera frame
  float brightness = 0;                              // of the light there, by what is seen of the surface
  float weight = 0;                                  // above 0
};

class HarmonicLight {
 public:
  using Harmonics = Eigen::Matrix<double, 9, 1>;  // in the order of kernels/terms/shading.cl

  explicit HarmonicLight(const HarmonicLightOptions& options);  // throws ConfigError

  // The samples of a frame whose pose is believed.
  void learn(std::span<const LightSample> samples);

  bool known() const { return frames_ >= options_.least_frames; }
  const Harmonics& light() const { return light_; }
  // Standard deviation of brightness that the light leaves unexplained, by weight, at least least_deviation.
  double deviation() const;
  // (brightness expected - seen) / deviation().
  double residual(const Eigen::Vector3d& normal, double brightness) const;

 private:
  double deviation_of(std::span<const LightSample> samples) const;

  HarmonicLightOptions options_;
  Eigen::Matrix<double, 9, 9> products_ = Eigen::Matrix<double, 9, 9>::Zero();
  Harmonics sums_ = Harmonics::Zero();
  Harmonics light_ = Harmonics::Zero();
  double deviation_ = 0;
  double frames_ = 0;  // how many its memory holds
};

}  // namespace livecap
