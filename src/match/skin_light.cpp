#include "match/skin_light.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/median.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kTintRate = 0.1;  // a frame's share of the tint's running mean

}  // namespace

void SkinLightOptions::validate() const {
  harmonics.validate();
  if (!(off_tint > 0) || !std::isfinite(off_tint))
    throw ConfigError(format("light option off_tint is %g; it must be finite and positive", off_tint));
}

SkinLight::SkinLight(const SkinLightOptions& options) : options_(options), harmonics_(options.harmonics) {
  options.validate();
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
  if (all.size() < size_t(options_.harmonics.least_samples)) return;
  learn_tint(all);
  std::vector<LightSample> samples;
  for (const SkinSample& s : all)
    if (s.area_px > 0) samples.push_back({s.normal, s.brightness, s.area_px});
  harmonics_.learn(samples);
}

}  // namespace livecap
