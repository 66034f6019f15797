#include "synth/scenario.h"

#include <algorithm>
#include <cmath>

#include "base/joined.h"
#include "livecap/error.h"

namespace livecap {

const std::vector<std::string>& scenario_names() {
  static const std::vector<std::string> names = {"none", "leave", "two-people", "moving-shadow", "similar-background",
                                                 "gap"};
  return names;
}

namespace synth {
namespace {

constexpr double kSideways = 70 * M_PI / 180;  // how far somebody who walks to the side is turned there

double smoothstep(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Color mean_color(const ActorModel& actor, Part part) {
  Color sum = Color::Zero();
  int n = 0;
  const auto& atlas = actor.atlas;
  for (size_t i = 0; i < atlas.uvs.size(); ++i) {
    if (actor.parts[atlas.vertex[i]] != part) continue;
    const int x = static_cast<int>(std::clamp(atlas.uvs[i].x(), 0.0, 0.999) * actor.texture.width);
    const int y = static_cast<int>(std::clamp(atlas.uvs[i].y(), 0.0, 0.999) * actor.texture.height);
    const uint8_t* texel = &actor.texture.pixels[3 * (static_cast<size_t>(y) * actor.texture.width + x)];
    for (int k = 0; k < 3; ++k) sum[k] += linear_from_srgb(static_cast<float>(texel[k]) / 255);
    ++n;
  }
  return sum / static_cast<float>(std::max(1, n));
}

}  // namespace

Scenario scenario_from_name(const std::string& name) {
  const auto& names = scenario_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<Scenario>(found - names.begin());
  throw ConfigError("there is no scenario '" + name + "'; there are: " + joined(names));
}

void leave_and_return(double t, double out_mm, Posture& posture) {
  constexpr double kStart = 0.5, kSpeed = 1300, kAway = 0.5, kTurn = 0.3;  // s, mm/s on average
  const double walk = out_mm / kSpeed, back = kStart + walk + kAway;
  posture.x_mm += out_mm * (smoothstep((t - kStart) / walk) - smoothstep((t - back) / walk));
  // Turned to where the way goes, to the camera at both ends of it.
  const auto on_the_way = [&](double start) {
    return smoothstep((t - start) / kTurn) * smoothstep((start + walk - t) / kTurn);
  };
  posture.yaw += kSideways * (on_the_way(kStart) - on_the_way(back));
}

std::optional<Posture> passer_by(double t, double out_mm, const Posture& walking) {
  constexpr double kStart = 0.3, kSpeed = 1400;  // s, mm/s
  const double x = kSpeed * (t - kStart) - out_mm;
  if (std::abs(x) > out_mm) return std::nullopt;
  Posture posture = walking;
  posture.x_mm = x;
  posture.z_mm = kPasserByZ;
  posture.yaw += kSideways;
  return posture;
}

MovingShadow moving_shadow(double t) {
  constexpr double kLeft = -1900, kRight = 900, kSweep = 1.6;  // mm, s
  const double phase = std::abs(std::remainder(t, 2 * kSweep)) / kSweep;
  return {kLeft + (kRight - kLeft) * phase, 300, 0.9};
}

bool is_left_out(double t) {
  constexpr double kFrom = 0.7, kTo = 0.8, kRounding = 1e-6;  // s; a beat or an arm's way, not its rest
  const double within = t - std::floor(t + kRounding);
  return within > kFrom - kRounding && within < kTo - kRounding;
}

Wallpaper clothes_wallpaper(const ActorModel& actor) {
  const BodyShape shape(outfit_from_name(actor.name));
  return {mean_color(actor, kTopPart), mean_color(actor, kBottomPart), actor.scale * shape.bottom_waist_y()};
}

}  // namespace synth
}  // namespace livecap
