// Reading and writing up to NN_PANEL channels of one pixel.
#ifndef LC_NN_PANEL_H
#define LC_NN_PANEL_H
#include "nn/op_params.h"

// Adds the residual, clamps, and writes the first n (>= 1; all when n >= 16) channels of v at element `at`.
static inline void nn_store_panel(NnOp op, global float* arena, int at, float16 v, int n) {
  if (op.residual_offset >= 0) v += vload16(0, arena + op.residual_offset + at);
  v = v > op.low ? v : (float16)(op.low);  // one instruction each, which clamp() is not
  v = v < op.high ? v : (float16)(op.high);
  global float* out = arena + op.out_offset + at;
  if (n >= 16) {
    vstore16(v, 0, out);
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

// Up to four channels of one pixel; those past the last one are left out.
static inline void nn_store4(NnOp op, global float* arena, int pixel, int channel, float4 v) {
  const int at = pixel * op.out_channels + channel;
  if (channel < op.out_channels) nn_store(op, arena, at, v.x);
  if (channel + 1 < op.out_channels) nn_store(op, arena, at + 1, v.y);
  if (channel + 2 < op.out_channels) nn_store(op, arena, at + 2, v.z);
  if (channel + 3 < op.out_channels) nn_store(op, arena, at + 3, v.w);
}

static inline float4 nn_broadcast_mad(float x, float4 w, float4 sum) {
  return (float4)(x)*w + sum;
}

// Work-items that share a panel, 4 channels each.
#define NN_LANES 4

// sum + the convolution's window over one output pixel for the four channels of a lane (count over all panels); of each
// tap every step-th input channel from `first` on.
static inline float4 nn_window_sum(NnOp op, global const float* restrict weights, global const float* arena, int pixel,
                                   int lane, int first, int step, float4 sum) {
  const int channels = op.in_channels;
  for (int ky = 0; ky < op.kernel_h; ++ky) {
    const int in_y = pixel / op.out_width * op.stride_h - op.pad_top + ky * op.dilation_h;
    if (in_y < 0 || in_y >= op.in_height) continue;
    for (int kx = 0; kx < op.kernel_w; ++kx) {
      const int in_x = pixel % op.out_width * op.stride_w - op.pad_left + kx * op.dilation_w;
      if (in_x < 0 || in_x >= op.in_width) continue;
      global const float* x = arena + op.in_offset + (in_y * op.in_width + in_x) * channels;
      global const float* restrict w = weights + op.weight_offset +
                                       ((lane / NN_LANES * op.kernel_h + ky) * op.kernel_w + kx) * channels * NN_PANEL +
                                       lane % NN_LANES * 4;
      for (int k = first; k < channels; k += step) sum = nn_broadcast_mad(x[k], vload4(0, w + k * NN_PANEL), sum);
    }
  }
  return sum;
}

#endif
