// All tolerances of the tests, each with its reason. Tighten, never loosen.
#pragma once

namespace livecap::test {

// Central differences in double with a step of 1e-5..1e-6: truncation plus rounding, relative to the largest entry.
inline constexpr double kFiniteDifference = 2e-6;
// One float operation chain of the shared formulas against the same in double.
inline constexpr double kFloatRelative = 3e-6;
// Double arithmetic that differs only in order.
inline constexpr double kDoubleExact = 1e-9;

// Float rasteriser against a double ray caster: perspective-correct depth from three edge values of a float each.
inline constexpr double kRasterDepthRelative = 1e-4;
// Barycentric coordinate below which rounding may decide whether a pixel centre lies in a triangle.
inline constexpr double kRasterEdge = 1e-3;

}  // namespace livecap::test
