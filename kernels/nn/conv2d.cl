// CONV_2D, NHWC: y[p, n] = clamp(bias[n] + sum over kernel taps and input channels of x[p + tap, k] * w[n, tap, k] +
// residual). On CPUs (GPUs: layers.cl) one work-item is a register tile of NN_TILE pixels x NN_PANEL channels.
#include "nn/panel.h"

// Written out: compilers contract the expression to one instruction; PoCL's mad() is a multiplication and an addition.
#define NN_MAD(x, w, sum) ((float16)(x) * (w) + (sum))

// The register tile: NN_TILE pixels of one panel (a) or of two neighbours (a, b), which halves the reads of inputs.
#define NN_EACH_PIXEL(M) M(0) M(1) M(2) M(3) M(4) M(5) M(6) M(7)
#define NN_CLEAR(p) float16 a##p = bias_a, b##p = bias_b;
#define NN_ADD_ONE(p) a##p = NN_MAD(NN_INPUT(p), wa, a##p);
#define NN_ADD_TWO(p)              \
  {                                \
    const float16 x = NN_INPUT(p); \
    a##p = x * wa + a##p;          \
    b##p = x * wb + b##p;          \
  }
#define NN_STORE(p)                                                                              \
  if (p < n_pixels) {                                                                            \
    nn_store_panel(op, arena, at + p * op.out_channels, a##p, n);                                \
    if (two) nn_store_panel(op, arena, at + p * op.out_channels + NN_PANEL, b##p, n - NN_PANEL); \
  }

// 1x1 kernel, stride 1: a matrix product [pixels x in_channels] [in_channels x out_channels]. One work-item = NN_STRIP
// pixels x two panels. count = strips * ceil(panels / 2).
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_pointwise(NnOp op, global const float* restrict weights,
                                                                          global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int all_pixels = op.out_height * op.out_width;
  const int n_strips = (all_pixels + NN_STRIP - 1) / NN_STRIP;
  const int n_pairs = (op.out_channels + 2 * NN_PANEL - 1) / (2 * NN_PANEL);
  const int strip = op.panels_innermost ? id / n_pairs : id % n_strips;
  const int panel = 2 * (op.panels_innermost ? id % n_pairs : id / n_strips);
  const int n = op.out_channels - panel * NN_PANEL;
  const int two = n > NN_PANEL;
  const int k_count = op.in_channels;
  global const float* restrict weights_a = weights + op.weight_offset + panel * k_count * NN_PANEL;
  global const float* restrict weights_b = weights_a + (two ? k_count * NN_PANEL : 0);
  const float16 bias_a = vload16(panel, weights + op.bias_offset);
  const float16 bias_b = vload16(panel + two, weights + op.bias_offset);
  const int end = min((strip + 1) * NN_STRIP, all_pixels);
  for (int first = strip * NN_STRIP; first < end; first += NN_TILE) {
    const int n_pixels = end - first;
    global const float* x = arena + op.in_offset + first * k_count;
#define NN_POINT(p) global const float* x##p = x + min(p, n_pixels - 1) * k_count;
    NN_EACH_PIXEL(NN_POINT)
    NN_EACH_PIXEL(NN_CLEAR)
#define NN_INPUT(p) x##p[k]
    if (two) {
      for (int k = 0; k < k_count; ++k) {
        const float16 wa = vload16(k, weights_a), wb = vload16(k, weights_b);
        NN_EACH_PIXEL(NN_ADD_TWO)
      }
    } else {
      for (int k = 0; k < k_count; ++k) {
        const float16 wa = vload16(k, weights_a);
        NN_EACH_PIXEL(NN_ADD_ONE)
      }
    }
#undef NN_INPUT
    const int at = first * op.out_channels + panel * NN_PANEL;
    NN_EACH_PIXEL(NN_STORE)
  }
}

// Any kernel, stride, dilation and padding. The tile is NN_TILE neighbours in one row; pixels outside the image are
// read from the zeros at the beginning of the arena. count = rows * tiles per row * ceil(panels / 2).
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_window(NnOp op, global const float* restrict weights,
                                                                       global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int tiles_per_row = (op.out_width + NN_TILE - 1) / NN_TILE;
  const int n_tiles = op.out_height * tiles_per_row;
  const int n_pairs = (op.out_channels + 2 * NN_PANEL - 1) / (2 * NN_PANEL);
  const int tile = op.panels_innermost ? id / n_pairs : id % n_tiles;
  const int panel = 2 * (op.panels_innermost ? id % n_pairs : id / n_tiles);
  const int y = tile / tiles_per_row;
  const int x_first = tile % tiles_per_row * NN_TILE;
  const int channels = op.in_channels;
  const int in_x = x_first * op.stride_w - op.pad_left;
  const int reach = (NN_TILE - 1) * op.stride_w + op.kernel_w;
  const int inside = op.dilation_w == 1 && in_x >= 0 && in_x + reach <= op.in_width;
  // Inside, the kernel's columns are contiguous in memory and count as one long row of inputs.
  const int n_segments = inside ? 1 : op.kernel_w;
  const int segment = inside ? op.kernel_w * channels : channels;
  const int n = op.out_channels - panel * NN_PANEL;
  const int two = n > NN_PANEL;
  const int panel_size = op.kernel_h * op.kernel_w * channels * NN_PANEL;
  const float16 bias_a = vload16(panel, weights + op.bias_offset);
  const float16 bias_b = vload16(panel + two, weights + op.bias_offset);
  NN_EACH_PIXEL(NN_CLEAR)
  for (int ky = 0; ky < op.kernel_h; ++ky) {
    const int in_y = y * op.stride_h - op.pad_top + ky * op.dilation_h;
    if (in_y < 0 || in_y >= op.in_height) continue;
    const int row = op.in_offset + in_y * op.in_width * channels;
    for (int s = 0; s < n_segments; ++s) {
      const int tap_x = in_x + s * op.dilation_w;
#define NN_PLACE(p)                          \
  const int px##p = tap_x + p * op.stride_w; \
  global const float* x##p = arena + (px##p >= 0 && px##p < op.in_width ? row + px##p * channels : 0);
      NN_EACH_PIXEL(NN_PLACE)
      global const float* restrict weights_a =
          weights + op.weight_offset + panel * panel_size + (ky * op.kernel_w + s) * channels * NN_PANEL;
      global const float* restrict weights_b = weights_a + (two ? panel_size : 0);
#define NN_INPUT(p) x##p[k]
      if (two) {
        for (int k = 0; k < segment; ++k) {
          const float16 wa = vload16(k, weights_a), wb = vload16(k, weights_b);
          NN_EACH_PIXEL(NN_ADD_TWO)
        }
      } else {
        for (int k = 0; k < segment; ++k) {
          const float16 wa = vload16(k, weights_a);
          NN_EACH_PIXEL(NN_ADD_ONE)
        }
      }
#undef NN_INPUT
    }
  }
  const int n_pixels = op.out_width - x_first;
  const int at = (y * op.out_width + x_first) * op.out_channels + panel * NN_PANEL;
  NN_EACH_PIXEL(NN_STORE)
}

// A window convolution to a few channels (a mask): a panel would be nearly empty, so the input channels are the vector.
// in_channels is a multiple of 8; weights are [cout][kh][kw][cin]. One work-item = one row. count = rows.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_narrow(NnOp op, global const float* restrict weights,
                                                                       global float* arena) {
  const int y = get_global_id(0);
  if (y >= op.count) return;
  const int channels = op.in_channels;
  const int segment = op.kernel_w * channels;
  for (int n = 0; n < op.out_channels; ++n) {
    global const float* restrict weights_n = weights + op.weight_offset + n * op.kernel_h * segment;
    const float bias = weights[op.bias_offset + n];
    for (int x = 0; x < op.out_width; ++x) {
      const int first_x = x * op.stride_w - op.pad_left;
      const int inside = op.dilation_w == 1 && first_x >= 0 && first_x + op.kernel_w <= op.in_width;
      float16 sum = (float16)(0.0f);
      for (int ky = 0; ky < op.kernel_h; ++ky) {
        const int in_y = y * op.stride_h - op.pad_top + ky * op.dilation_h;
        if (in_y < 0 || in_y >= op.in_height) continue;
        global const float* restrict w = weights_n + ky * segment;
        const int row = op.in_offset + in_y * op.in_width * channels;
        if (inside) {  // the kernel's columns are contiguous
          global const float* p = arena + row + first_x * channels;
          int k = 0;
          for (; k + 16 <= segment; k += 16) sum = vload16(0, p + k) * vload16(0, w + k) + sum;
          if (k < segment) sum.lo = vload8(0, p + k) * vload8(0, w + k) + sum.lo;
          continue;
        }
        for (int kx = 0; kx < op.kernel_w; ++kx, w += channels) {
          const int in_x = first_x + kx * op.dilation_w;
          if (in_x < 0 || in_x >= op.in_width) continue;
          global const float* p = arena + row + in_x * channels;
          for (int k = 0; k < channels; k += 8) sum.lo = vload8(0, p + k) * vload8(0, w + k) + sum.lo;
        }
      }
      const float8 eight = sum.lo + sum.hi;
      const float4 four = eight.lo + eight.hi;
      const float2 pair = four.lo + four.hi;
      nn_store(op, arena, (y * op.out_width + x) * op.out_channels + n, bias + pair.x + pair.y);
    }
  }
}
