// The light that falls on bare skin, learned from the frames already solved: spherical harmonics of order 2 fitted to
// brightness by albedo, robustly, older frames counting less; and its tint, which tells skin from what hides it.
#pragma once

#include <Eigen/Core>
#include <span>

namespace livecap {

struct SkinLightOptions {
  double memory_frames = 100;     // after so many a frame's say has fallen to 1/e
  double least_frames = 5;        // before the light is known
  double least_deviation = 0.03;  // of brightness; less is not believed
  double full_area_px = 800;      // a frame that shows less skin counts less
  int least_samples = 20;         // a frame with fewer tells nothing
  double off_tint = 0.2;          // what differs more from the skin's tint is none; on rendered skin 0.05 do

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
  using Harmonics = Eigen::Matrix<double, 9, 1>;  // in the order of kernels/terms/shading.cl

  explicit SkinLight(const SkinLightOptions& options);

  // The samples of a frame whose pose is believed. Those of another colour only count for the tint: it follows when a
  // camera changes its white balance. Most of them must be of skin.
  void learn(std::span<const SkinSample> all);

  bool known() const { return frames_ >= options_.least_frames; }
  const Harmonics& light() const { return light_; }
  // Median of the samples' tints, averaged over frames; ones before the first.
  const Eigen::Vector2d& tint() const { return tint_; }
  // How far from it, red or blue, something else begins; of no account before the first frame.
  double off_tint() const;
  // Standard deviation of brightness that the light leaves unexplained, at least least_deviation.
  double deviation() const;
  // (brightness expected - seen) / deviation().
  double residual(const Eigen::Vector3d& normal, double brightness) const;

 private:
  void fit();
  void learn_tint(std::span<const SkinSample> samples);

  SkinLightOptions options_;
  Eigen::Matrix<double, 9, 9> products_ = Eigen::Matrix<double, 9, 9>::Zero();
  Harmonics sums_ = Harmonics::Zero();
  Harmonics light_ = Harmonics::Zero();
  Eigen::Vector2d tint_ = Eigen::Vector2d::Ones();
  bool knows_tint_ = false;
  double deviation_ = 0;
  double frames_ = 0;  // how many its memory holds
};

}  // namespace livecap
