// Reading and writing up to NN_PANEL channels of one pixel.
#ifndef LC_NN_PANEL_H
#define LC_NN_PANEL_H
#include "nn/op_params.h"
#include "shared/wide.h"

// Adds the residual, clamps, and writes the first n (>= 1; all when n >= 16) channels of v at element `at`.
static inline void nn_store_panel(NnOp op, global float* arena, int at, float16 v, int n) {
  if (op.residual_offset >= 0) v += vload16(0, arena + op.residual_offset + at);
  v = v > op.low ? v : (float16)(op.low);  // one instruction each, which clamp() is not
  v = v < op.high ? v : (float16)(op.high);
  global float* out = arena + op.out_offset + at;
  if (n >= 16) {
    store16(v, out);
    return;
  }
  float8 rest = v.lo;
  if (n & 8) {
    vstore8(v.lo, 0, out);
    rest = v.hi;
    out += 8;
  }
  float4 rest4 = rest.lo;
  if (n & 4) {
    vstore4(rest.lo, 0, out);
    rest4 = rest.hi;
    out += 4;
  }
  float2 rest2 = rest4.lo;
  if (n & 2) {
    vstore2(rest4.lo, 0, out);
    rest2 = rest4.hi;
    out += 2;
  }
  if (n & 1) out[0] = rest2.x;
}

// One element, the same way.
static inline void nn_store(NnOp op, global float* arena, int at, float v) {
  if (op.residual_offset >= 0) v += arena[op.residual_offset + at];
  arena[op.out_offset + at] = clamp(v, op.low, op.high);
}

#endif
