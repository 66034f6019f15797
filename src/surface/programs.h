// The programs of kernels/surface.
#pragma once

namespace livecap {

inline constexpr char kSurfaceProgram[] = "surface/surface.cl";
inline constexpr char kSurfaceSlicesProgram[] = "surface/slices.cl";

}  // namespace livecap
