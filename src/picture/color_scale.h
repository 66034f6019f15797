// Colours that stand for numbers and names, the same in every picture.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace livecap {

using Rgb = std::array<float, 3>;  // 0..255

// White to yellow, red and nearly black; value is clamped to 0..1.
Rgb heat_color(double value);
// Of every value, as a share of what has the last colour, as OverlayOptions::colors takes them: [3*n] in [0,1].
std::vector<float> heat_colors(std::span<const double> values, double largest);
// Red (-1) over light grey (0) to blue (+1), as the paper draws what the surface stage improves.
Rgb diverging_color(double value);
// A colour of the circle, 0..1 and round again, and how bright, 0..1.
Rgb hue_color(double hue, double value);
// One per LIP class (actor/labels.h); grey for 0.
Rgb label_color(int label);

}  // namespace livecap
