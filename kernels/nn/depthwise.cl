// DEPTHWISE_CONV_2D, NHWC: y[p, c] = clamp(bias[c] + sum over kernel taps of x[p + tap, c] * w[tap, c] + residual).
// On CPUs (GPUs: layers.cl) one work-item is one output row x NN_PANEL channels, 4 pixels at a time, the weights in
// registers.
#include "nn/panel.h"

// KxK, dilation 1, stride STEP along rows. A vector holds NN_PANEL channels of one pixel, or with PIXELS = 2 all eight
// channels of two neighbours (weights and biases are then packed twice). Four vectors at a time share the inputs their
// windows overlap in. count = panels * rows.
#define NN_DEPTHWISE(NAME, K, STEP, PIXELS)                                                                          \
  kernel __attribute__((reqd_work_group_size(1, 1, 1))) void NAME(NnOp op, global const float* restrict weights,     \
                                                                  global float* arena) {                             \
    const int id = get_global_id(0);                                                                                 \
    if (id >= op.count) return;                                                                                      \
    const int n_panels = (op.out_channels + NN_PANEL - 1) / NN_PANEL;                                                \
    const int y = id / n_panels;                                                                                     \
    const int panel = id % n_panels;                                                                                 \
    const int channels = op.in_channels;                                                                             \
    const int n = channels - panel * NN_PANEL;                                                                       \
    const int in_y = y * op.stride_h - op.pad_top;                                                                   \
    const int image = op.in_offset + panel * NN_PANEL;                                                               \
    float16 w[K * K];                                                                                                \
    _Pragma("unroll") for (int i = 0; i < K * K; ++i) w[i] = vload16(panel * K * K + i, weights + op.weight_offset); \
    const float16 bias = vload16(panel, weights + op.bias_offset);                                                   \
    int x = 0;                                                                                                       \
    while (x < op.out_width) {                                                                                       \
      float16 a0 = bias, a1 = bias, a2 = bias, a3 = bias;                                                            \
      const int in_x = x * STEP - op.pad_left;                                                                       \
      const int at = (y * op.out_width + x) * channels + panel * NN_PANEL;                                           \
      if (in_x >= 0 && in_x + (4 * PIXELS - 1) * STEP + K <= op.in_width && x + 4 * PIXELS <= op.out_width) {        \
        _Pragma("unroll") for (int ky = 0; ky < K; ++ky) {                                                           \
          if (in_y + ky < 0 || in_y + ky >= op.in_height) continue;                                                  \
          global const float* p = arena + image + ((in_y + ky) * op.in_width + in_x) * channels;                     \
          _Pragma("unroll") for (int kx = 0; kx < K; ++kx) {                                                         \
            a0 = vload16(0, p + kx * channels) * w[ky * K + kx] + a0;                                                \
            a1 = vload16(0, p + (kx + STEP * PIXELS) * channels) * w[ky * K + kx] + a1;                              \
            a2 = vload16(0, p + (kx + 2 * STEP * PIXELS) * channels) * w[ky * K + kx] + a2;                          \
            a3 = vload16(0, p + (kx + 3 * STEP * PIXELS) * channels) * w[ky * K + kx] + a3;                          \
          }                                                                                                          \
        }                                                                                                            \
        nn_store_panel(op, arena, at, a0, n* PIXELS);                                                                \
        nn_store_panel(op, arena, at + PIXELS * channels, a1, n * PIXELS);                                           \
        nn_store_panel(op, arena, at + 2 * PIXELS * channels, a2, n * PIXELS);                                       \
        nn_store_panel(op, arena, at + 3 * PIXELS * channels, a3, n * PIXELS);                                       \
        x += 4 * PIXELS;                                                                                             \
        continue;                                                                                                    \
      }                                                                                                              \
      _Pragma("unroll") for (int ky = 0; ky < K; ++ky) {                                                             \
        if (in_y + ky < 0 || in_y + ky >= op.in_height) continue;                                                    \
        const int row = image + (in_y + ky) * op.in_width * channels;                                                \
        _Pragma("unroll") for (int kx = 0; kx < K; ++kx) {                                                           \
          const int x0 = in_x + kx, x1 = x0 + STEP, x2 = x1 + STEP, x3 = x2 + STEP;                                  \
          a0 = vload16(0, arena + (x0 >= 0 && x0 < op.in_width ? row + x0 * channels : 0)) * w[ky * K + kx] + a0;    \
          a1 = vload16(0, arena + (x1 >= 0 && x1 < op.in_width ? row + x1 * channels : 0)) * w[ky * K + kx] + a1;    \
          a2 = vload16(0, arena + (x2 >= 0 && x2 < op.in_width ? row + x2 * channels : 0)) * w[ky * K + kx] + a2;    \
          a3 = vload16(0, arena + (x3 >= 0 && x3 < op.in_width ? row + x3 * channels : 0)) * w[ky * K + kx] + a3;    \
        }                                                                                                            \
      }                                                                                                              \
      nn_store_panel(op, arena, at, a0, n);                                                                          \
      if (x + 1 < op.out_width) nn_store_panel(op, arena, at + channels, a1, n);                                     \
      if (x + 2 < op.out_width) nn_store_panel(op, arena, at + 2 * channels, a2, n);                                 \
      if (x + 3 < op.out_width) nn_store_panel(op, arena, at + 3 * channels, a3, n);                                 \
      x += 4;                                                                                                        \
    }                                                                                                                \
  }

NN_DEPTHWISE(depthwise_3x3, 3, 1, 1)
NN_DEPTHWISE(depthwise_3x3_stride_2, 3, 2, 1)
NN_DEPTHWISE(depthwise_3x3_pairs, 3, 1, 2)
#if LC_VECTOR == 16
NN_DEPTHWISE(depthwise_5x5, 5, 1, 1)
NN_DEPTHWISE(depthwise_5x5_stride_2, 5, 2, 1)
#else

// Where sixteen channels are two of 16 registers: eight channels of NN_TOGETHER pixels at a time and a row of weights
// in registers. Each column of the inputs is read once for all pixels whose windows it is in.
#define NN_TOGETHER 8

// COUNTS: whether column j is in the image.
#define NN_HALF_ROW(K, STEP, COUNTS)                                         \
  _Pragma("unroll") for (int j = 0; j < (NN_TOGETHER - 1) * STEP + K; ++j) { \
    if (!(COUNTS)) continue;                                                 \
    const float8 v = vload8(0, row + j * channels);                          \
    _Pragma("unroll") for (int i = 0; i < NN_TOGETHER; ++i) {                \
      const int kx = j - i * STEP;                                           \
      if (kx >= 0 && kx < K) sum[i] = v * w_row[kx] + sum[i];                \
    }                                                                        \
  }
#define NN_DEPTHWISE_HALVES(NAME, K, STEP)                                                                       \
  kernel __attribute__((reqd_work_group_size(1, 1, 1))) void NAME(NnOp op, global const float* restrict weights, \
                                                                  global float* arena) {                         \
    const int id = get_global_id(0);                                                                             \
    if (id >= op.count) return;                                                                                  \
    const int n_panels = (op.out_channels + NN_PANEL - 1) / NN_PANEL;                                            \
    const int y = id / n_panels;                                                                                 \
    const int panel = id % n_panels;                                                                             \
    const int channels = op.in_channels;                                                                         \
    const int in_y = y * op.stride_h - op.pad_top;                                                               \
    for (int x = 0; x < op.out_width; x += NN_TOGETHER) {                                                        \
      const int in_x = x * STEP - op.pad_left;                                                                   \
      const int inside = in_x >= 0 && in_x + (NN_TOGETHER - 1) * STEP + K <= op.in_width;                        \
      for (int c = panel * NN_PANEL; c < min((panel + 1) * NN_PANEL, channels); c += NN_PANEL / 2) {             \
        global const float* restrict w = weights + op.weight_offset + panel * K * K * NN_PANEL + c % NN_PANEL;   \
        const float8 bias = vload8(0, weights + op.bias_offset + c);                                             \
        float8 sum[NN_TOGETHER];                                                                                 \
        _Pragma("unroll") for (int i = 0; i < NN_TOGETHER; ++i) sum[i] = bias;                                   \
        for (int ky = max(0, -in_y); ky < min(K, op.in_height - in_y); ++ky) {                                   \
          float8 w_row[K];                                                                                       \
          _Pragma("unroll") for (int kx = 0; kx < K; ++kx) w_row[kx] = vload8(0, w + (ky * K + kx) * NN_PANEL);  \
          global const float* row = arena + op.in_offset + ((in_y + ky) * op.in_width + in_x) * channels + c;    \
          if (inside) {                                                                                          \
            NN_HALF_ROW(K, STEP, 1)                                                                              \
          } else {                                                                                               \
            NN_HALF_ROW(K, STEP, in_x + j >= 0 && in_x + j < op.in_width)                                        \
          }                                                                                                      \
        }                                                                                                        \
        const int at = (y * op.out_width + x) * channels + c;                                                    \
        _Pragma("unroll") for (int i = 0; i < NN_TOGETHER; ++i) {                                                \
          if (x + i < op.out_width) nn_store_half(op, arena, at + i * channels, sum[i], channels - c);           \
        }                                                                                                        \
      }                                                                                                          \
    }                                                                                                            \
  }

NN_DEPTHWISE_HALVES(depthwise_5x5, 5, 1)
NN_DEPTHWISE_HALVES(depthwise_5x5_stride_2, 5, 2)
#endif

// Any kernel. One work-item = one pixel x NN_PANEL channels. count = pixels * panels.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void depthwise_any(NnOp op, global const float* restrict weights,
                                                                         global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int n_panels = (op.out_channels + NN_PANEL - 1) / NN_PANEL;
  const int pixel = id / n_panels;
  const int panel = id % n_panels;
  float16 sum = vload16(panel, weights + op.bias_offset);
  for (int ky = 0; ky < op.kernel_h; ++ky) {
    const int in_y = pixel / op.out_width * op.stride_h - op.pad_top + ky * op.dilation_h;
    if (in_y < 0 || in_y >= op.in_height) continue;
    for (int kx = 0; kx < op.kernel_w; ++kx) {
      const int in_x = pixel % op.out_width * op.stride_w - op.pad_left + kx * op.dilation_w;
      if (in_x < 0 || in_x >= op.in_width) continue;
      const int at = op.in_offset + (in_y * op.in_width + in_x) * op.in_channels + panel * NN_PANEL;
      sum =
          vload16(0, arena + at) * vload16((panel * op.kernel_h + ky) * op.kernel_w + kx, weights + op.weight_offset) +
          sum;
    }
  }
  nn_store_panel(op, arena, pixel * op.out_channels + panel * NN_PANEL, sum, op.out_channels - panel * NN_PANEL);
}
