#include "match/harmonic_light.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

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

HarmonicLight::Harmonics harmonics_of(const Eigen::Vector3d& n) {
  const reference::Harmonics h = reference::harmonics(reference::vec3(n.x(), n.y(), n.z()));
  return HarmonicLight::Harmonics(h.of);
}

}  // namespace

void HarmonicLightOptions::validate() const {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(format("light option %s is %g; it must be finite and positive", field, value));
  };
  positive("memory_frames", memory_frames);
  positive("least_frames", least_frames);
  positive("least_deviation", least_deviation);
  positive("full_weight", full_weight);
  positive("least_samples", least_samples);
}

HarmonicLight::HarmonicLight(const HarmonicLightOptions& options) : options_(options) {
  options.validate();
}

double HarmonicLight::deviation() const {
  return std::max(deviation_, options_.least_deviation);
}

double HarmonicLight::residual(const Eigen::Vector3d& normal, double brightness) const {
  return (harmonics_of(normal).dot(light_) - brightness) / deviation();
}

double HarmonicLight::deviation_of(std::span<const LightSample> samples) const {
  std::vector<std::pair<double, double>> errors;  // and weights
  errors.reserve(samples.size());
  double half = 0;
  for (const LightSample& s : samples) {
    errors.emplace_back(std::abs(harmonics_of(s.normal.cast<double>()).dot(light_) - s.brightness), s.weight);
    half += s.weight / 2;
  }
  std::sort(errors.begin(), errors.end());
  size_t median = 0;
  for (double below = errors[0].second; below < half && median + 1 < errors.size();) below += errors[++median].second;
  return kDeviationPerMedian * errors[median].first;
}

void HarmonicLight::learn(std::span<const LightSample> samples) {
  if (samples.size() < size_t(options_.least_samples)) return;
  double sum = 0;
  for (const LightSample& s : samples) sum += s.weight;
  if (!(sum > 0) || !std::isfinite(sum)) return;
  const bool first = frames_ == 0;
  const double keep = std::exp(-1 / options_.memory_frames);
  const double share = std::min(1.0, sum / options_.full_weight);
  if (!first) deviation_ += kDeviationRate * (deviation_of(samples) - deviation_);
  products_ *= keep;
  sums_ *= keep;
  frames_ = keep * frames_ + share;
  for (const LightSample& s : samples) {
    const Harmonics h = harmonics_of(s.normal.cast<double>());
    const double r = first ? 0 : (h.dot(light_) - s.brightness) / (kDoubtful * deviation());
    const double weight = share * s.weight / sum / (1 + r * r);
    products_ += weight * h * h.transpose();
    sums_ += weight * s.brightness * h;
  }
  Eigen::Matrix<double, 9, 9> system = products_;
  for (int k = 0; k < 9; ++k) system(k, k) += kPrior[k];
  light_ = system.ldlt().solve(sums_);
  if (first) deviation_ = deviation_of(samples);
}

}  // namespace livecap
