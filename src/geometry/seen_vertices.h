// What a picture shows of the template's vertices as the kernels that looked for it left it on the device, for stage I
// to choose from there (kernels/pose/choose.cl).
#pragma once

#include <array>
#include <cstdint>

#include "geometry/shaded_vertex.h"
#include "ocl/buffer.h"

namespace livecap {

// Bare skin; nothing where samples is nullptr.
struct SeenSkin {
  // In deviations of what it leaves unexplained.
  struct Light {
    bool is_known = false;
    livecap::Light light{};
    double deviation = 1;  // of brightness
  };
  const ocl::Buffer<float>* samples = nullptr;     // [LC_SKIN*n], see kernels/match/layout.h
  const ocl::Buffer<int32_t>* vertices = nullptr;  // [n]
  const ocl::Buffer<int32_t>* limbs = nullptr;     // [n] twice the limb, 0..7, and 1 for the second light
  float limb_area_px = 1;                          // a limb that shows so many px^2 or more has weight 1
  std::array<Light, 2> lights;
};

struct SeenVertices {
  const ocl::Buffer<int32_t>* contour = nullptr;  // [n_vertices] 1 for contour vertices; nullptr: none
  const ocl::Buffer<float>* matches = nullptr;    // [LC_MATCH*n_vertices], see kernels/match/layout.h; nullptr: none
  float match_area_px = 1;                        // a match that stands for so many px^2 has weight 1
  SeenSkin skin;
};

}  // namespace livecap
