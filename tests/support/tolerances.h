// All tolerances of the tests, each with its reason. Tighten, never loosen.
#pragma once

namespace livecap::test {

// Central differences in double with a step of 1e-5..1e-6: truncation plus rounding, relative to the largest entry.
inline constexpr double kFiniteDifference = 2e-6;
// One float operation chain of the shared formulas against the same in double.
inline constexpr double kFloatRelative = 3e-6;
// Double arithmetic that differs only in order.
inline constexpr double kDoubleExact = 1e-9;
// A term's residual in float: the terms subtract numbers of up to 5000 (mm, px), whose rounding is 2.4e-4 each.
inline constexpr double kTermResidual = 1e-3;
// A row of the pose stage's J on the device against double, relative to its largest entry: about 100 float operations
// from bone motions to wrenches, and differences of moments ten times larger than their result.
inline constexpr double kPoseJacobian = 5e-5;
// J^T J of some 600 float rows against the same sum in double, relative to sqrt(A_ii A_jj).
inline constexpr double kGramFloat = 3e-6;
// A solver that had its model and exact data: mm between its keypoints and the true ones.
inline constexpr double kRecoveredMm = 1.0;
// The initialisation alone: near enough for Gauss-Newton, mm.
inline constexpr double kInitializedMm = 80;
// Energy of the paper's few steps over that of a trusted solver run to convergence.
inline constexpr double kEnergyRatio = 1.01;

}  // namespace livecap::test
