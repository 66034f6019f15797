// Reading and writing up to NN_PANEL channels of one pixel.
#ifndef LC_NN_PANEL_H
#define LC_NN_PANEL_H
#include "nn/op_params.h"
#include "shared/wide.h"

// Writes the first n of up to 8 channels.
static inline void nn_write_half(float8 v, global float* out, int n) {
  if (n >= 8) {
    store8(v, out);
    return;
  }
  float4 rest = v.lo;
  if (n & 4) {
    vstore4(v.lo, 0, out);
    rest = v.hi;
    out += 4;
  }
  float2 rest2 = rest.lo;
  if (n & 2) {
    vstore2(rest.lo, 0, out);
    rest2 = rest.hi;
    out += 2;
  }
  if (n & 1) out[0] = rest2.x;
}

// v within op.low..op.high, by one instruction each, which clamp() is not.
#define NN_LIMIT(T, v, op)              \
  do {                                  \
    v = v > op.low ? v : (T)(op.low);   \
    v = v < op.high ? v : (T)(op.high); \
  } while (0)

// Adds the residual, clamps, and writes the first n (>= 1; all when n >= 16) channels of v at element `at`.
static inline void nn_store_panel(NnOp op, global float* arena, int at, float16 v, int n) {
  if (op.residual_offset >= 0) v += vload16(0, arena + op.residual_offset + at);
  NN_LIMIT(float16, v, op);
  global float* out = arena + op.out_offset + at;
  if (n >= 16) {
    store16(v, out);
    return;
  }
  nn_write_half(v.lo, out, n);
  if (n > 8) nn_write_half(v.hi, out + 8, n - 8);
}

// The same with up to 8.
static inline void nn_store_half(NnOp op, global float* arena, int at, float8 v, int n) {
  if (op.residual_offset >= 0) v += vload8(0, arena + op.residual_offset + at);
  NN_LIMIT(float8, v, op);
  nn_write_half(v, arena + op.out_offset + at, n);
}

// One element, the same way.
static inline void nn_store(NnOp op, global float* arena, int at, float v) {
  if (op.residual_offset >= 0) v += arena[op.residual_offset + at];
  NN_LIMIT(float, v, op);
  arena[op.out_offset + at] = v;
}

#endif
