// CONV_2D, NHWC: y[p, n] = clamp(bias[n] + sum over kernel taps and input channels of x[p + tap, k] * w[n, tap, k] +
// residual). On a CPU one work-item is a register tile of NN_TILE pixels x NN_PANEL channels; on a GPU 4 work-items
// share a panel (see also conv_split.cl).
#include "nn/panel.h"

#define NN_MAD(x, w, sum) mad((float16)(x), w, sum)

#if LC_CPU

// 1x1 kernel, stride 1: a matrix product [pixels x in_channels] [in_channels x out_channels].
// count = tiles of pixels * panels.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_pointwise(NnOp op, global const float* restrict weights,
                                                                          global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int n_pixels = op.out_height * op.out_width;
  const int n_tiles = (n_pixels + NN_TILE - 1) / NN_TILE;
  const int n_panels = (op.out_channels + NN_PANEL - 1) / NN_PANEL;
  const int tile = op.panels_innermost ? id / n_panels : id % n_tiles;
  const int panel = op.panels_innermost ? id % n_panels : id / n_tiles;
  const int first = tile * NN_TILE;
  const int last = n_pixels - 1;
  const int k_count = op.in_channels;
  global const float* restrict w = weights + op.weight_offset + panel * k_count * NN_PANEL;
  global const float* x = arena + op.in_offset;
  global const float* x0 = x + first * k_count;
  global const float* x1 = x + min(first + 1, last) * k_count;
  global const float* x2 = x + min(first + 2, last) * k_count;
  global const float* x3 = x + min(first + 3, last) * k_count;
  global const float* x4 = x + min(first + 4, last) * k_count;
  global const float* x5 = x + min(first + 5, last) * k_count;
  global const float* x6 = x + min(first + 6, last) * k_count;
  global const float* x7 = x + min(first + 7, last) * k_count;
  const float16 bias = vload16(panel, weights + op.bias_offset);
  float16 a0 = bias, a1 = bias, a2 = bias, a3 = bias, a4 = bias, a5 = bias, a6 = bias, a7 = bias;
  for (int k = 0; k < k_count; ++k) {
    const float16 wk = vload16(k, w);
    a0 = NN_MAD(x0[k], wk, a0);
    a1 = NN_MAD(x1[k], wk, a1);
    a2 = NN_MAD(x2[k], wk, a2);
    a3 = NN_MAD(x3[k], wk, a3);
    a4 = NN_MAD(x4[k], wk, a4);
    a5 = NN_MAD(x5[k], wk, a5);
    a6 = NN_MAD(x6[k], wk, a6);
    a7 = NN_MAD(x7[k], wk, a7);
  }
  const int n = op.out_channels - panel * NN_PANEL;
  const int stride = op.out_channels;
  const int at = first * stride + panel * NN_PANEL;
  nn_store_panel(op, arena, at, a0, n);
  if (first + 1 <= last) nn_store_panel(op, arena, at + stride, a1, n);
  if (first + 2 <= last) nn_store_panel(op, arena, at + 2 * stride, a2, n);
  if (first + 3 <= last) nn_store_panel(op, arena, at + 3 * stride, a3, n);
  if (first + 4 <= last) nn_store_panel(op, arena, at + 4 * stride, a4, n);
  if (first + 5 <= last) nn_store_panel(op, arena, at + 5 * stride, a5, n);
  if (first + 6 <= last) nn_store_panel(op, arena, at + 6 * stride, a6, n);
  if (first + 7 <= last) nn_store_panel(op, arena, at + 7 * stride, a7, n);
}

// Any kernel, stride, dilation and padding. The tile is NN_TILE neighbours in one row; pixels outside the image are
// read from the zeros at the beginning of the arena. count = rows * tiles per row * panels.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_window(NnOp op, global const float* restrict weights,
                                                                       global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int tiles_per_row = (op.out_width + NN_TILE - 1) / NN_TILE;
  const int n_tiles = op.out_height * tiles_per_row;
  const int n_panels = (op.out_channels + NN_PANEL - 1) / NN_PANEL;
  const int tile = op.panels_innermost ? id / n_panels : id % n_tiles;
  const int panel = op.panels_innermost ? id % n_panels : id / n_tiles;
  const int y = tile / tiles_per_row;
  const int x_first = tile % tiles_per_row * NN_TILE;
  const int channels = op.in_channels;
  const int in_x = x_first * op.stride_w - op.pad_left;
  const int reach = (NN_TILE - 1) * op.stride_w + op.kernel_w;
  const int inside = op.dilation_w == 1 && in_x >= 0 && in_x + reach <= op.in_width;
  // Inside, the kernel's columns are contiguous in memory and count as one long row of inputs.
  const int n_segments = inside ? 1 : op.kernel_w;
  const int segment = inside ? op.kernel_w * channels : channels;
  const float16 bias = vload16(panel, weights + op.bias_offset);
  float16 a0 = bias, a1 = bias, a2 = bias, a3 = bias, a4 = bias, a5 = bias, a6 = bias, a7 = bias;
  for (int ky = 0; ky < op.kernel_h; ++ky) {
    const int in_y = y * op.stride_h - op.pad_top + ky * op.dilation_h;
    if (in_y < 0 || in_y >= op.in_height) continue;
    const int row = op.in_offset + in_y * op.in_width * channels;
    for (int s = 0; s < n_segments; ++s) {
      const int tap_x = in_x + s * op.dilation_w;
      int at[NN_TILE];
#pragma unroll
      for (int p = 0; p < NN_TILE; ++p) {
        const int px = tap_x + p * op.stride_w;
        at[p] = px >= 0 && px < op.in_width ? row + px * channels : 0;
      }
      global const float* restrict w =
          weights + op.weight_offset + ((panel * op.kernel_h + ky) * op.kernel_w + s) * channels * NN_PANEL;
      for (int k = 0; k < segment; ++k) {
        const float16 wk = vload16(k, w);
        a0 = NN_MAD(arena[at[0] + k], wk, a0);
        a1 = NN_MAD(arena[at[1] + k], wk, a1);
        a2 = NN_MAD(arena[at[2] + k], wk, a2);
        a3 = NN_MAD(arena[at[3] + k], wk, a3);
        a4 = NN_MAD(arena[at[4] + k], wk, a4);
        a5 = NN_MAD(arena[at[5] + k], wk, a5);
        a6 = NN_MAD(arena[at[6] + k], wk, a6);
        a7 = NN_MAD(arena[at[7] + k], wk, a7);
      }
    }
  }
  const int n = op.out_channels - panel * NN_PANEL;
  const int stride = op.out_channels;
  const int at = (y * op.out_width + x_first) * stride + panel * NN_PANEL;
  const int n_pixels = op.out_width - x_first;
  nn_store_panel(op, arena, at, a0, n);
  if (n_pixels > 1) nn_store_panel(op, arena, at + stride, a1, n);
  if (n_pixels > 2) nn_store_panel(op, arena, at + 2 * stride, a2, n);
  if (n_pixels > 3) nn_store_panel(op, arena, at + 3 * stride, a3, n);
  if (n_pixels > 4) nn_store_panel(op, arena, at + 4 * stride, a4, n);
  if (n_pixels > 5) nn_store_panel(op, arena, at + 5 * stride, a5, n);
  if (n_pixels > 6) nn_store_panel(op, arena, at + 6 * stride, a6, n);
  if (n_pixels > 7) nn_store_panel(op, arena, at + 7 * stride, a7, n);
}

// A window convolution to a few channels (a mask): a panel would be nearly empty, so the input channels are the vector.
// in_channels is a multiple of 8; weights are [cout][kh][kw][cin]. One work-item = one row. count = rows.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_narrow(NnOp op, global const float* restrict weights,
                                                                       global float* arena) {
  const int y = get_global_id(0);
  if (y >= op.count) return;
  const int channels = op.in_channels;
  for (int n = 0; n < op.out_channels; ++n) {
    for (int x = 0; x < op.out_width; ++x) {
      float8 sum = (float8)(0.0f);
      global const float* restrict w = weights + op.weight_offset + n * op.kernel_h * op.kernel_w * channels;
      for (int ky = 0; ky < op.kernel_h; ++ky) {
        const int in_y = y * op.stride_h - op.pad_top + ky * op.dilation_h;
        for (int kx = 0; kx < op.kernel_w; ++kx, w += channels) {
          const int in_x = x * op.stride_w - op.pad_left + kx * op.dilation_w;
          if (in_y < 0 || in_y >= op.in_height || in_x < 0 || in_x >= op.in_width) continue;
          global const float* p = arena + op.in_offset + (in_y * op.in_width + in_x) * channels;
          for (int k = 0; k < channels; k += 8) sum = mad(vload8(0, p + k), vload8(0, w + k), sum);
        }
      }
      const float4 half_sum = sum.lo + sum.hi;
      const float2 quarter = half_sum.lo + half_sum.hi;
      nn_store(op, arena, (y * op.out_width + x) * op.out_channels + n,
               weights[op.bias_offset + n] + quarter.x + quarter.y);
    }
  }
}

#else

#define NN_PIXELS_GPU 4  // pixels of one work-item

// One work-item = 4 pixels x 4 channels. count = ceil(pixels / 4) * panels * 4.
kernel void conv_pointwise(NnOp op, global const float* restrict weights, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int n_pixels = op.out_height * op.out_width;
  const int n_lanes = (op.out_channels + NN_PANEL - 1) / NN_PANEL * NN_LANES;
  const int lane = id % n_lanes;
  const int first = id / n_lanes * NN_PIXELS_GPU;
  const int panel = lane / NN_LANES;
  const int channel = lane * 4;
  const int k_count = op.in_channels;
  global const float* restrict w = weights + op.weight_offset + panel * k_count * NN_PANEL + lane % NN_LANES * 4;
  global const float* x0 = arena + op.in_offset + first * k_count;
  global const float* x1 = arena + op.in_offset + min(first + 1, n_pixels - 1) * k_count;
  global const float* x2 = arena + op.in_offset + min(first + 2, n_pixels - 1) * k_count;
  global const float* x3 = arena + op.in_offset + min(first + 3, n_pixels - 1) * k_count;
  const float4 bias = vload4(lane, weights + op.bias_offset);
  float4 a0 = bias, a1 = bias, a2 = bias, a3 = bias;
  for (int k = 0; k < k_count; ++k) {
    const float4 wk = vload4(0, w + k * NN_PANEL);
    a0 = nn_broadcast_mad(x0[k], wk, a0);
    a1 = nn_broadcast_mad(x1[k], wk, a1);
    a2 = nn_broadcast_mad(x2[k], wk, a2);
    a3 = nn_broadcast_mad(x3[k], wk, a3);
  }
  nn_store4(op, arena, first, channel, a0);
  if (first + 1 < n_pixels) nn_store4(op, arena, first + 1, channel, a1);
  if (first + 2 < n_pixels) nn_store4(op, arena, first + 2, channel, a2);
  if (first + 3 < n_pixels) nn_store4(op, arena, first + 3, channel, a3);
}

// One work-item = 1 pixel x 4 channels. count = pixels * panels * 4.
kernel void conv_window(NnOp op, global const float* restrict weights, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int n_lanes = (op.out_channels + NN_PANEL - 1) / NN_PANEL * NN_LANES;
  const int lane = id % n_lanes;
  const int pixel = id / n_lanes;
  const float4 bias = vload4(lane, weights + op.bias_offset);
  nn_store4(op, arena, pixel, lane * 4, nn_window_sum(op, weights, arena, pixel, lane, 0, 1, bias));
}

#endif
