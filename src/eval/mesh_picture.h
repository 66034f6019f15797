// Pictures of a mesh for reports: a plain host rasteriser with a depth buffer and one colour per vertex, lit from the
// viewer. For people to look at; no figure depends on it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/image_rgb.h"
#include "eval/mask_raster.h"
#include "livecap/camera.h"

namespace livecap {

using Rgb = std::array<float, 3>;  // 0..255

// White to yellow, red and nearly black; value is clamped to 0..1.
Rgb heat_color(double value);
// Red (-1) over light grey (0) to blue (+1), as the paper draws what the surface stage improves.
Rgb diverging_color(double value);

// As seen by a camera. positions: [3*n] mm, camera frame. The mesh covers what is on the canvas, which has the camera's
// size (LogicError).
void paint_mesh(std::span<const float> positions_mm, std::span<const int32_t> triangles, std::span<const Rgb> colors,
                const Camera& camera, ImageRgb& canvas);

// A template at rest (+X the subject's left, +Y up, +Z the front) from its front, left, back and right side by side, in
// parallel projection on a white canvas of this height.
ImageRgb paint_turnaround(std::span<const float> rest_mm, std::span<const int32_t> triangles,
                          std::span<const Rgb> colors, int height_px);

}  // namespace livecap
