// All tolerances of the tests, each with its reason. Tighten, never loosen.
#pragma once

namespace livecap::test {

// Central differences in double with a step of 1e-5..1e-6: truncation plus rounding, relative to the largest entry.
inline constexpr double kFiniteDifference = 2e-6;
// One float operation chain of the shared formulas against the same in double.
inline constexpr double kFloatRelative = 3e-6;
// Double arithmetic that differs only in order.
inline constexpr double kDoubleExact = 1e-9;

// A position of up to two metres that went through float once or twice, in mm (2^-23 * 2000, a few operations).
inline constexpr double kMillimetreFloat = 2e-3;
// A direction between two such positions some 300 mm apart.
inline constexpr double kDirectionFloat = 1e-5;
// Face vertices of the recorded truth against the rest template, in mm: the face is skinned to the head and neck only,
// float32 metres, and its lower rim bends a little with the neck.
inline constexpr double kRigidFaceMm = 0.5;

}  // namespace livecap::test
