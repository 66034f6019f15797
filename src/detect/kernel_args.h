// Arguments of kernels/detect/crop.cl as the kernels have them.
#pragma once

#include <cstdint>

namespace livecap::detect {

inline constexpr char kCropProgram[] = "detect/crop.cl";

// Blocks: the picture's part that is looked at.
struct BlocksArg {
  int32_t picture_width, x0, y0, width, height, factor;
  float share;  // 1 / factor^2
};

// int4: where the outputs begin.
struct OutputsArg {
  int32_t landmarks, score, heatmap, world;
};

}  // namespace livecap::detect
