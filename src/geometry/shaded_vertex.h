// How bright the picture shows the skin at a vertex of the template: what the match room finds and stage I fits to.
#pragma once

#include <array>
#include <cstdint>

namespace livecap {

// Spherical harmonics of order 2 in the order of kernels/terms/shading.cl.
using Light = std::array<float, 9>;

struct ShadedVertex {
  int32_t vertex = 0;
  Light light{};         // L, and
  float brightness = 0;  // b, both in standard deviations of what L leaves unexplained
  float weight = 1;      // factor of the squared residual
};

}  // namespace livecap
