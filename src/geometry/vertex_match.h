// Where a picture shows a vertex of the template: what the match room finds and stage I fits to.
#pragma once

#include <cstdint>

namespace livecap {

struct VertexMatch {
  int32_t vertex = 0;
  float u_px = 0;
  float v_px = 0;
  // Root of the weight of a distance (du, dv), px: its residuals are (a du + b dv, c dv). Eigenvalues of the weight are
  // 1 along directions in which the match is certain, towards 0 along those in which it is not.
  float a = 1;
  float b = 0;
  float c = 1;
  float weight = 1;  // factor of the squared residuals
};

}  // namespace livecap
