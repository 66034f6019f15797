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

// Float rasteriser against a double ray caster: perspective-correct depth from three edge values of a float each.
inline constexpr double kRasterDepthRelative = 1e-4;
// Barycentric coordinate below which rounding may decide whether a pixel centre lies in a triangle.
inline constexpr double kRasterEdge = 1e-3;
// A position of up to two metres that went through float once or twice, in mm (2^-23 * 2000, a few operations).
inline constexpr double kMillimetreFloat = 2e-3;
// A direction between two such positions some 300 mm apart.
inline constexpr double kDirectionFloat = 1e-5;
// Face vertices of the recorded truth against the rest template, in mm: the face is skinned to the head and neck only,
// float32 metres, and its lower rim bends a little with the neck.
inline constexpr double kRigidFaceMm = 0.5;

// Stage II in float against double, relative norm: projections at some 300 px carry 3e-5 px of rounding, which a random
// image turns into 1e-5 of colour per tap.
inline constexpr double kSurfaceSystem = 2e-5;
// A weighted mean of at most 256 8-bit values in float.
inline constexpr double kBlurredColor = 1e-6;
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

// Eight decimals of a degree and of a unit along a chain of a metre and a half, in metres.
inline constexpr double kBvhMetres = 2e-7;
// Seven significant digits of a few metres.
inline constexpr double kCsvMetres = 2e-6;
// Morph targets stop when what they leave out is below 0.02 mm; int16 shapes and float weights add about as much.
inline constexpr double kMorphMeanMm = 0.05;
// The writer's own account of its error against what a viewer computes from the float32 file some metres away.
inline constexpr double kGlbReportMm = 5e-3;
// 64 shapes for 150 frames of dancing with a skirt on a rigid body (nearly all motion is residual), in mm.
inline constexpr double kClothMeanMm = 0.7;

}  // namespace livecap::test
