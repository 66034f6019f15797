// All tolerances of the tests, each with its reason. Tighten, never loosen.
#pragma once

namespace livecap::test {

// Central differences in double with a step of 1e-5..1e-6: truncation plus rounding, relative to the largest entry.
inline constexpr double kFiniteDifference = 2e-6;
// One float operation chain of the shared formulas against the same in double.
inline constexpr double kFloatRelative = 3e-6;
// Double arithmetic that differs only in order.
inline constexpr double kDoubleExact = 1e-9;

// Stage II in float against double, relative norm: projections at some 300 px carry 3e-5 px of rounding, which a random
// image turns into 1e-5 of colour per tap.
inline constexpr double kSurfaceSystem = 2e-5;
// A weighted mean of at most 256 8-bit values in float.
inline constexpr double kBlurredColor = 1e-6;
// Trapezoidal rule over 0.014 px of a blurred white-noise image plus float rounding of the positions.
inline constexpr double kBlurredGradientStep = 1e-5;
// Converged Jacobi sweeps on moves of some 25 mm added to positions of 300 mm in float, mm.
inline constexpr double kHarmonicBand = 1e-3;
// Energy after 15 inexact steps in float against 15 direct ones in double, relative.
inline constexpr double kSurfaceMinimum = 1e-3;
// Mean over the inner vertices after the standard 3 x 4 solve; regularisers and blur leave a part of the way.
inline constexpr double kRecoveredTranslationPx = 0.3;
// A mesh at rest 2 m away: float rounding of positions (1.2e-4 mm) through three steps.
inline constexpr double kSurfaceRestMm = 1e-3;
// Contour vertices of a sphere pulled 5 px with converged linear solves: what the regularisers keep, px.
inline constexpr double kContourPx = 0.2;

}  // namespace livecap::test
