// A template from all sides, one colour per vertex, for reports.
#pragma once

#include <cstdint>
#include <span>

#include "base/image_rgb.h"
#include "picture/color_scale.h"

namespace livecap {

// A template at rest (+X the subject's left, +Y up, +Z the front) from its front, left, back and right side by side, in
// parallel projection on a white canvas of this height.
ImageRgb paint_turnaround(std::span<const float> rest_mm, std::span<const int32_t> triangles,
                          std::span<const Rgb> colors, int height_px);

}  // namespace livecap
