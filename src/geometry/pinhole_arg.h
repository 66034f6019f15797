// A camera as kernels take it: the Pinhole of kernels/shared/camera.h by value.
#pragma once

#include "livecap/camera.h"

namespace livecap {

struct PinholeArg {
  float fx, fy, cx, cy;  // px
};
static_assert(sizeof(PinholeArg) == 16);

// Distortion is ignored: images are undistorted.
inline PinholeArg pinhole_arg(const Camera& camera) {
  return {static_cast<float>(camera.fx), static_cast<float>(camera.fy), static_cast<float>(camera.cx),
          static_cast<float>(camera.cy)};
}

}  // namespace livecap
