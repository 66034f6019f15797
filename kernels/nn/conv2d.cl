// CONV_2D, NHWC: y[p, n] = clamp(bias[n] + sum over kernel taps and input channels of x[p + tap, k] * w[n, tap, k] +
// residual). On CPUs (GPUs: layers.cl) one work-item makes two panels of some pixels, a register tile at a time.
#include "nn/panel.h"

// Register tiles, pixels x output channels: with AVX-512 eight pixels x two panels take half of the 32 registers, and
// two panels halve the reads of inputs. Elsewhere a panel is two of 16 registers: six pixels x a panel, or eight x half
// a panel. Sums are written out: compilers contract them to one instruction; PoCL's mad() is a multiplication and an
// addition.
#define NN_6_PIXELS(M) M(0) M(1) M(2) M(3) M(4) M(5)
#define NN_8_PIXELS(M) NN_6_PIXELS(M) M(6) M(7)

// Weights are read once a frame, from the last level of the cache or from memory, page by page: asked for so many
// input channels ahead where panels go two at a time.
#define NN_AHEAD 32
#if LC_CPU && defined(__has_builtin)
#if __has_builtin(__builtin_prefetch)
#define NN_SOON(p) __builtin_prefetch((const void*)(size_t)(p));
#endif
#endif
#ifndef NN_SOON
#define NN_SOON(p)
#endif

#define NN_HALF_BIAS const float8 bias = vload8(0, biases);
#define NN_HALF_CLEAR(p) float8 a##p = bias;
#define NN_HALF_WEIGHTS const float8 wa = vload8(0, w + k * NN_PANEL);
#define NN_HALF_ADD(p) a##p = x##p[k] * wa + a##p;
#define NN_HALF_STORE(p) \
  if (p < n_pixels) nn_store_half(op, arena, at + p * op.out_channels, a##p, n);

#define NN_ONE_BIAS const float16 bias = vload16(0, biases);
#define NN_ONE_CLEAR(p) float16 a##p = bias;
#define NN_ONE_WEIGHTS const float16 wa = vload16(k, w);
#define NN_ONE_ADD(p) a##p = x##p[k] * wa + a##p;
#define NN_ONE_STORE(p) \
  if (p < n_pixels) nn_store_panel(op, arena, at + p * op.out_channels, a##p, n);

#define NN_TWO_BIAS const float16 bias = vload16(0, biases), bias_b = vload16(1, biases);
#define NN_TWO_CLEAR(p) float16 a##p = bias, b##p = bias_b;
#define NN_TWO_WEIGHTS                                               \
  const float16 wa = vload16(k, w), wb = vload16(k, w + panel_size); \
  NN_SOON(w + (k + NN_AHEAD) * NN_PANEL) NN_SOON(w + panel_size + (k + NN_AHEAD) * NN_PANEL)
#define NN_TWO_ADD(p)          \
  {                            \
    const float16 x = x##p[k]; \
    a##p = x * wa + a##p;      \
    b##p = x * wb + b##p;      \
  }
#define NN_TWO_STORE(p)                                                                 \
  if (p < n_pixels) {                                                                   \
    nn_store_panel(op, arena, at + p * op.out_channels, a##p, n);                       \
    nn_store_panel(op, arena, at + p * op.out_channels + NN_PANEL, b##p, n - NN_PANEL); \
  }

// Output channels from c on of pixels first..end-1, by a kernel of 1x1. Where there are as many pixels as in a tile
// the last tile lies at the end, over pixels that are made already: to ask for every pixel whether there is one takes
// as long as few input channels do.
#define NN_POINT(p) global const float* x##p = x + p * op.in_channels;
#define NN_POINT_OF_FEW(p) global const float* x##p = x + min(p, n_pixels - 1) * op.in_channels;
#define NN_POINTWISE_TILE(KIND, COUNT, POINT)                                                               \
  {                                                                                                         \
    global const float* x = arena + op.in_offset + first * op.in_channels;                                  \
    NN_##COUNT##_PIXELS(POINT) NN_##COUNT##_PIXELS(KIND##_CLEAR) for (int k = 0; k < op.in_channels; ++k) { \
      KIND##_WEIGHTS NN_##COUNT##_PIXELS(KIND##_ADD)                                                        \
    }                                                                                                       \
    const int at = first * op.out_channels + c;                                                             \
    NN_##COUNT##_PIXELS(KIND##_STORE)                                                                       \
  }
#define NN_POINTWISE_TILES(NAME, KIND, COUNT)                                                       \
  static inline void NAME(NnOp op, int first, int end, int c, global const float* restrict weights, \
                          global float* arena) {                                                    \
    const int n = op.out_channels - c, panel_size = op.in_channels * NN_PANEL;                      \
    global const float* restrict w = weights + op.weight_offset + c / NN_PANEL * panel_size;        \
    global const float* restrict biases = weights + op.bias_offset + c;                             \
    KIND##_BIAS if (end - first < COUNT) {                                                          \
      const int n_pixels = end - first;                                                             \
      NN_POINTWISE_TILE(KIND, COUNT, NN_POINT_OF_FEW)                                               \
      return;                                                                                       \
    }                                                                                               \
    for (int next = first; next < end; next += COUNT) {                                             \
      const int n_pixels = COUNT;                                                                   \
      first = min(next, end - COUNT);                                                               \
      NN_POINTWISE_TILE(KIND, COUNT, NN_POINT)                                                      \
    }                                                                                               \
  }

// Likewise of columns first..end-1 of row y, by any kernel. Inside the image the kernel's columns are contiguous in
// memory and count as one long row of inputs; what is outside is read from the zeros at the beginning of the arena.
#define NN_PLACE(p)                          \
  const int px##p = tap_x + p * op.stride_w; \
  global const float* x##p = arena + (px##p >= 0 && px##p < op.in_width ? row + px##p * channels : 0);
#define NN_WINDOW_TILES(NAME, KIND, COUNT)                                                                           \
  static inline void NAME(NnOp op, int y, int first, int end, int c, global const float* restrict weights,           \
                          global float* arena) {                                                                     \
    const int channels = op.in_channels;                                                                             \
    const int n = op.out_channels - c, panel_size = op.kernel_h * op.kernel_w * channels * NN_PANEL;                 \
    global const float* restrict biases = weights + op.bias_offset + c;                                              \
    KIND##_BIAS for (; first < end; first += COUNT) {                                                                \
      const int n_pixels = end - first;                                                                              \
      const int in_x = first * op.stride_w - op.pad_left;                                                            \
      const int reach = (COUNT - 1) * op.stride_w + op.kernel_w;                                                     \
      const int inside = op.dilation_w == 1 && in_x >= 0 && in_x + reach <= op.in_width;                             \
      const int n_segments = inside ? 1 : op.kernel_w;                                                               \
      const int segment = inside ? op.kernel_w * channels : channels;                                                \
      NN_##COUNT##_PIXELS(KIND##_CLEAR) for (int ky = 0; ky < op.kernel_h; ++ky) {                                   \
        const int in_y = y * op.stride_h - op.pad_top + ky * op.dilation_h;                                          \
        if (in_y < 0 || in_y >= op.in_height) continue;                                                              \
        const int row = op.in_offset + in_y * op.in_width * channels;                                                \
        for (int s = 0; s < n_segments; ++s) {                                                                       \
          const int tap_x = in_x + s * op.dilation_w;                                                                \
          NN_##COUNT##_PIXELS(NN_PLACE) global const float* restrict w =                                             \
              weights + op.weight_offset + c / NN_PANEL * panel_size + (ky * op.kernel_w + s) * channels * NN_PANEL; \
          for (int k = 0; k < segment; ++k) {                                                                        \
            KIND##_WEIGHTS NN_##COUNT##_PIXELS(KIND##_ADD)                                                           \
          }                                                                                                          \
        }                                                                                                            \
      }                                                                                                              \
      const int at = (y * op.out_width + first) * op.out_channels + c;                                               \
      NN_##COUNT##_PIXELS(KIND##_STORE)                                                                              \
    }                                                                                                                \
  }

#if LC_VECTOR == 16
NN_POINTWISE_TILES(pointwise_one, NN_ONE, 8)
NN_POINTWISE_TILES(pointwise_two, NN_TWO, 8)
NN_WINDOW_TILES(window_one, NN_ONE, 8)
NN_WINDOW_TILES(window_two, NN_TWO, 8)
#else
NN_POINTWISE_TILES(pointwise_half, NN_HALF, 8)
NN_POINTWISE_TILES(pointwise_one, NN_ONE, 6)
NN_WINDOW_TILES(window_half, NN_HALF, 8)
NN_WINDOW_TILES(window_one, NN_ONE, 6)
#endif

// Up to two panels from output channel c on, of which n are left: TILES(kind, channel) calls one of the above.
#if LC_VECTOR == 16
#define NN_TWO_PANELS(TILES) \
  if (n > NN_PANEL) {        \
    TILES(two, c);           \
  } else {                   \
    TILES(one, c);           \
  }
#else
#define NN_TWO_PANELS(TILES)                                 \
  if (n > NN_PANEL / 2) TILES(one, c);                       \
  if (n > NN_PANEL + NN_PANEL / 2) TILES(one, c + NN_PANEL); \
  const int rest = n % NN_PANEL;                             \
  if (n < 2 * NN_PANEL && rest > 0 && rest <= NN_PANEL / 2) TILES(half, c + n - rest);
#endif

// 1x1 kernel, stride 1: a matrix product [pixels x in_channels] [in_channels x out_channels]. One work-item = NN_STRIP
// pixels x two panels. count = strips * ceil(panels / 2).
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_pointwise(NnOp op, global const float* restrict weights,
                                                                          global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int n_pixels = op.out_height * op.out_width;
  const int n_strips = (n_pixels + NN_STRIP - 1) / NN_STRIP;
  const int n_pairs = (op.out_channels + 2 * NN_PANEL - 1) / (2 * NN_PANEL);
  const int first = (op.panels_innermost ? id / n_pairs : id % n_strips) * NN_STRIP;
  const int c = (op.panels_innermost ? id % n_pairs : id / n_strips) * 2 * NN_PANEL;
  const int end = min(first + NN_STRIP, n_pixels), n = op.out_channels - c;
#define TILES(KIND, at) pointwise_##KIND(op, first, end, at, weights, arena)
  NN_TWO_PANELS(TILES)
#undef TILES
}

// Any kernel, stride, dilation and padding. One work-item = NN_TILE neighbours in one row x two panels. count = rows *
// tiles per row * ceil(panels / 2).
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_window(NnOp op, global const float* restrict weights,
                                                                       global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int tiles_per_row = (op.out_width + NN_TILE - 1) / NN_TILE;
  const int n_tiles = op.out_height * tiles_per_row;
  const int n_pairs = (op.out_channels + 2 * NN_PANEL - 1) / (2 * NN_PANEL);
  const int tile = op.panels_innermost ? id / n_pairs : id % n_tiles;
  const int c = (op.panels_innermost ? id % n_pairs : id / n_tiles) * 2 * NN_PANEL;
  const int y = tile / tiles_per_row;
  const int first = tile % tiles_per_row * NN_TILE;
  const int end = min(first + NN_TILE, op.out_width), n = op.out_channels - c;
#define TILES(KIND, at) window_##KIND(op, y, first, end, at, weights, arena)
  NN_TWO_PANELS(TILES)
#undef TILES
}

// A window convolution to a few channels (a mask): a panel would be nearly empty, so the input channels are the vector,
// in_channels, a multiple of 8, and weights are [cout][kh][kw][cin]. Four neighbours at a time hide the latency of the
// additions.
typedef struct {
  float16 a, b, c, d;
} NnNarrowSums;

// Of a pixel whose window begins in column first_x; where that lies `inside` the image, in b, c and d of the windows
// `apart` floats further each.
static inline NnNarrowSums narrow_sums(NnOp op, int first_x, int y, int inside, int apart,
                                       global const float* restrict weights_n, global const float* arena) {
  const int channels = op.in_channels, segment = op.kernel_w * channels;
  float16 a = 0.0f, b = 0.0f, c = 0.0f, d = 0.0f;
  for (int ky = 0; ky < op.kernel_h; ++ky) {
    const int in_y = y * op.stride_h - op.pad_top + ky * op.dilation_h;
    if (in_y < 0 || in_y >= op.in_height) continue;
    global const float* restrict w = weights_n + ky * segment;
    const int row = op.in_offset + in_y * op.in_width * channels;
    if (inside) {  // the kernel's columns are contiguous
      global const float* p = arena + row + first_x * channels;
      int k = 0;
      for (; k + 16 <= segment; k += 16) {
        const float16 v = vload16(0, w + k);
        a = vload16(0, p + k) * v + a;
        b = vload16(0, p + apart + k) * v + b;
        c = vload16(0, p + 2 * apart + k) * v + c;
        d = vload16(0, p + 3 * apart + k) * v + d;
      }
      if (k < segment) {
        const float8 v = vload8(0, w + k);
        a.lo = vload8(0, p + k) * v + a.lo;
        b.lo = vload8(0, p + apart + k) * v + b.lo;
        c.lo = vload8(0, p + 2 * apart + k) * v + c.lo;
        d.lo = vload8(0, p + 3 * apart + k) * v + d.lo;
      }
      continue;
    }
    for (int kx = 0; kx < op.kernel_w; ++kx, w += channels) {
      const int in_x = first_x + kx * op.dilation_w;
      if (in_x < 0 || in_x >= op.in_width) continue;
      global const float* p = arena + row + in_x * channels;
      for (int k = 0; k < channels; k += 8) a.lo = vload8(0, p + k) * vload8(0, w + k) + a.lo;
    }
  }
  const NnNarrowSums sums = {a, b, c, d};
  return sums;
}

static inline float4 folded(float16 sum) {
  const float8 eight = sum.lo + sum.hi;
  return eight.lo + eight.hi;
}

// One work-item = one row. count = rows.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void conv_narrow(NnOp op, global const float* restrict weights,
                                                                       global float* arena) {
  const int y = get_global_id(0);
  if (y >= op.count) return;
  for (int n = 0; n < op.out_channels; ++n) {
    global const float* restrict weights_n =
        weights + op.weight_offset + n * op.kernel_h * op.kernel_w * op.in_channels;
    const float bias = weights[op.bias_offset + n];
    for (int x = 0; x < op.out_width;) {
      const int first_x = x * op.stride_w - op.pad_left;
      const int inside = op.dilation_w == 1 && first_x >= 0 && first_x + op.kernel_w <= op.in_width;
      const int four =
          inside && x + 4 <= op.out_width && first_x + 3 * op.stride_w + op.kernel_w <= op.in_width ? 1 : 0;
      const NnNarrowSums sums =
          narrow_sums(op, first_x, y, inside, four * op.stride_w * op.in_channels, weights_n, arena);
      const float4 a = folded(sums.a), b = folded(sums.b), c = folded(sums.c), d = folded(sums.d);
      const float4 even = (float4)(a.x, b.x, c.x, d.x) + (float4)(a.z, b.z, c.z, d.z);
      const float4 odd = (float4)(a.y, b.y, c.y, d.y) + (float4)(a.w, b.w, c.w, d.w);
      const float4 value = bias + even + odd;
      const int at = (y * op.out_width + x) * op.out_channels + n;
      nn_store(op, arena, at, value.x);
      if (four) {
        nn_store(op, arena, at + op.out_channels, value.y);
        nn_store(op, arena, at + 2 * op.out_channels, value.z);
        nn_store(op, arena, at + 3 * op.out_channels, value.w);
      }
      x += four ? 4 : 1;
    }
  }
}
