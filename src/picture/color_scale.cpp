#include "picture/color_scale.h"

#include <algorithm>
#include <cmath>

namespace livecap {
namespace {

constexpr double kGoldenShare = 0.381966;  // of the circle: neighbours in number differ in hue

Rgb interpolate(std::span<const Rgb> stops, double value) {
  const double position = std::clamp(value, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const size_t below = std::min(static_cast<size_t>(position), stops.size() - 2);
  const float t = static_cast<float>(position - static_cast<double>(below));
  Rgb color;
  for (int k = 0; k < 3; ++k) color[k] = (1 - t) * stops[below][k] + t * stops[below + 1][k];
  return color;
}

}  // namespace

Rgb heat_color(double value) {
  static constexpr Rgb kStops[] = {{246, 244, 238}, {253, 220, 160}, {252, 150, 90},
                                   {222, 60, 40},   {140, 10, 40},   {40, 0, 40}};
  return interpolate(kStops, value);
}

std::vector<float> heat_colors(std::span<const double> values, double largest) {
  std::vector<float> colors;
  for (double value : values) {
    for (float channel : heat_color(value / largest)) colors.push_back(channel / 255);
  }
  return colors;
}

Rgb diverging_color(double value) {
  static constexpr Rgb kStops[] = {{165, 15, 21}, {239, 110, 80}, {240, 240, 238}, {90, 150, 220}, {8, 60, 140}};
  return interpolate(kStops, 0.5 + 0.5 * value);
}

Rgb hue_color(double hue, double value) {
  Rgb color;
  for (int k = 0; k < 3; ++k) {
    const double h = std::fmod(hue + k / 3.0, 1.0);
    color[k] = static_cast<float>(255 * value * (0.25 + 0.75 * std::clamp(std::abs(6 * h - 3) - 1, 0.0, 1.0)));
  }
  return color;
}

Rgb label_color(int label) {
  return label == 0 ? Rgb{127.5f, 127.5f, 127.5f} : hue_color(kGoldenShare * label + 0.1, label % 3 ? 0.95 : 0.65);
}

}  // namespace livecap
