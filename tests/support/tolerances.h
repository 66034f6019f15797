// All tolerances of the tests, each with its reason. Tighten, never loosen.
#pragma once

namespace livecap::test {

// Central differences in double with a step of 1e-5..1e-6: truncation plus rounding, relative to the largest entry.
inline constexpr double kFiniteDifference = 2e-6;
// One float operation chain of the shared formulas against the same in double.
inline constexpr double kFloatRelative = 3e-6;
// Double arithmetic that differs only in order.
inline constexpr double kDoubleExact = 1e-9;

}  // namespace livecap::test
