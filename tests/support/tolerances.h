// All tolerances of the tests, each with its reason. Tighten, never loosen.
#pragma once

namespace livecap::test {

// Central differences in double with a step of 1e-5..1e-6: truncation plus rounding, relative to the largest entry.
inline constexpr double kFiniteDifference = 2e-6;
// One float operation chain of the shared formulas against the same in double.
inline constexpr double kFloatRelative = 3e-6;
// Double arithmetic that differs only in order.
inline constexpr double kDoubleExact = 1e-9;
// One network layer in float against sums in double, relative to the layer's largest value: up to 1,632 terms a sum.
inline constexpr double kLayerRelative = 2e-5;
// A whole network (up to 300 layers, recorded mask and heatmaps rounded to half precision), |a - b| / |b|.
inline constexpr double kNetworkRelative = 1e-3;
// Values computed by hand to seven digits.
inline constexpr double kHandComputed = 1e-6;
// Pixels are bytes: half a step of rounding on either side.
inline constexpr double kByteRounding = 1.0;
// Landmarks of a network run whose outputs agree to kNetworkRelative (1e-3 of coordinates up to 256 px and 900 mm); seen 1e-3.
inline constexpr double kLandmarkPx = 0.05;
inline constexpr double kLandmarkMm = 0.5;

}  // namespace livecap::test
