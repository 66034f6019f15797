#include "match/skin_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "base/median.h"
#include "base/text.h"
#include "geometry/reference.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Frames' worth of "no light from there" for each harmonic: normals that were never seen must not be guessed.
constexpr double kPrior[] = {0, 0.3, 0.3, 0.3, 1, 1, 1, 1, 1};
// Cauchy's weight is a half at so many deviations.
constexpr double kDoubtful = 2;
constexpr double kDeviationPerMedian = 1.48;  // of a normal distribution
constexpr double kDeviationRate = 0.1;        // a frame's share of the deviation's running mean
constexpr double kTintRate = 0.1;             // likewise of the tint's

SkinLight::Harmonics harmonics_of(const Eigen::Vector3d& n) {
  const reference::Harmonics h = reference::harmonics(reference::vec3(n.x(), n.y(), n.z()));
  return SkinLight::Harmonics(h.of);
}

}  // namespace

void SkinLightOptions::validate() const {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(format("light option %s is %g; it must be finite and positive", field, value));
  };
  positive("memory_frames", memory_frames);
  positive("least_frames", least_frames);
  positive("least_deviation", least_deviation);
  positive("full_area_px", full_area_px);
  positive("least_samples", least_samples);
  positive("off_tint", off_tint);
}

SkinLight::SkinLight(const SkinLightOptions& options) : options_(options) {
  options.validate();
}

double SkinLight::deviation() const {
  return std::max(deviation_, options_.least_deviation);
}

double SkinLight::residual(const Eigen::Vector3d& normal, double brightness) const {
  return (harmonics_of(normal).dot(light_) - brightness) / deviation();
}

void SkinLight::fit() {
  Eigen::Matrix<double, 9, 9> system = products_;
  for (int k = 0; k < 9; ++k) system(k, k) += kPrior[k];
  light_ = system.ldlt().solve(sums_);
}

double SkinLight::off_tint() const {
  return knows_tint_ ? options_.off_tint : std::numeric_limits<float>::max();
}

void SkinLight::learn_tint(std::span<const SkinSample> samples) {
  for (int k = 0; k < 2; ++k) {
    std::vector<double> seen;
    for (const SkinSample& s : samples) {
      if (s.brightness > 0) seen.push_back(s.tint[k]);
    }
    if (seen.empty()) return;
    tint_[k] += (knows_tint_ ? kTintRate : 1) * (median(std::move(seen)) - tint_[k]);
  }
  knows_tint_ = true;
}

void SkinLight::learn(std::span<const SkinSample> all) {
  if (all.size() < size_t(options_.least_samples)) return;
  learn_tint(all);
  std::vector<SkinSample> samples;
  std::copy_if(all.begin(), all.end(), std::back_inserter(samples), [](const SkinSample& s) { return s.area_px > 0; });
  if (samples.size() < size_t(options_.least_samples)) return;
  const auto deviation_now = [&] {
    std::vector<double> errors;
    for (const SkinSample& s : samples)
      errors.push_back(std::abs(harmonics_of(s.normal.cast<double>()).dot(light_) - s.brightness));
    return kDeviationPerMedian * median(std::move(errors));
  };
  double area = 0;
  for (const SkinSample& s : samples) area += s.area_px;
  const bool first = frames_ == 0;
  const double keep = std::exp(-1 / options_.memory_frames);
  const double share = std::min(1.0, area / options_.full_area_px);
  if (!first) deviation_ += kDeviationRate * (deviation_now() - deviation_);
  products_ *= keep;
  sums_ *= keep;
  frames_ = keep * frames_ + share;
  for (const SkinSample& s : samples) {
    const Eigen::Vector3d normal = s.normal.cast<double>();
    const double r = first ? 0 : residual(normal, s.brightness) / kDoubtful;
    const double weight = share * s.area_px / area / (1 + r * r);
    const Harmonics h = harmonics_of(normal);
    products_ += weight * h * h.transpose();
    sums_ += weight * s.brightness * h;
  }
  fit();
  if (first) deviation_ = deviation_now();
}

}  // namespace livecap
