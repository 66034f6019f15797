// The captured surface over a picture, textured and lit from the camera, or painted otherwise. For people to look at:
// plain C++, not part of the method.
#pragma once

#include <span>

#include "actor/actor.h"
#include "base/image_rgb.h"
#include "livecap/camera.h"

namespace livecap {

// What is nearer to the camera is not drawn.
inline constexpr float kMinDepthMm = 100;

struct OverlayOptions {
  float alpha = 0.85f;     // opacity of the actor, 0..1
  bool texture = true;     // false: plain grey, which shows the shape best
  bool shading = true;     // light from the camera
  bool key_light = false;  // with shading: less of it and a lamp at the upper left, which shows folds
  // Instead of texture and grey:
  std::span<const float> colors{};  // [3*n_vertices] sRGB in [0,1]; empty: none
  float checks_mm = 0;  // > 0: cubes of this side, light and dark, fixed to the surface at rest; they show it slide
  // On top of either:
  float wire_px = 0;  // > 0: the edges of the triangles, this wide

  void validate() const;  // throws ConfigError
};

// positions_camera: [3*n_vertices] mm, camera frame (LogicError for another size, of colours as well). camera: without
// distortion; its size is the background's (ConfigError). Triangles nearer than 100 mm or not finite are left out.
ImageRgb render_overlay(const Actor& actor, std::span<const float> positions_camera, const Camera& camera,
                        const ImageRgb& background, const OverlayOptions& options = {});

}  // namespace livecap
