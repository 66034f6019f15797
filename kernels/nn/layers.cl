// A network's layers on GPUs, all of them in one launch: its work-groups share each layer's outputs and wait for each
// other before the next.
#include "nn/panel.h"
#include "nn/pool_window.h"
#include "nn/resize_sample.h"
#include "shared/all_arrived.h"

#define PIXELS 4  // of a tile: 4 pixels x 4 channels

static inline float4 load_aligned(global const float* p) {  // a multiple of 16 bytes; vload4 makes four loads of it
  return *(global const float4*)p;
}

// Adds the residual, clamps, and writes up to four channels of one pixel.
static inline void store4(NnOp op, global float* arena, int pixel, int channel, float4 v) {
  const int at = pixel * op.out_channels + channel;
  if (op.out_channels % 4 == 0) {
    if (op.residual_offset >= 0) v += load_aligned(arena + op.residual_offset + at);
    *(global float4*)(arena + op.out_offset + at) = clamp(v, (float4)(op.low), (float4)(op.high));
    return;
  }
  if (channel < op.out_channels) nn_store(op, arena, at, v.x);
  if (channel + 1 < op.out_channels) nn_store(op, arena, at + 1, v.y);
  if (channel + 2 < op.out_channels) nn_store(op, arena, at + 2, v.z);
  if (channel + 3 < op.out_channels) nn_store(op, arena, at + 3, v.w);
}

// 1x1 convolutions. The work-items of a group are `slices` times as many tiles; each slice sums a run of input
// channels, the runs are added in order.
static void pointwise(NnOp op, int slices, global const float* restrict weights, global float* arena,
                      local float4* sums) {
  const int id = get_local_id(0);
  const int group_tiles = NN_GROUP / slices;
  const int slice = id / group_tiles;
  const int n_pixels = op.out_height * op.out_width;
  const int n_lanes = (op.out_channels + 3) / 4;
  const int n_tiles = (n_pixels + PIXELS - 1) / PIXELS * n_lanes;
  const int n = op.in_channels;
  const int run = ((n + slices - 1) / slices + 3) / 4 * 4;
  const int begin = min(slice * run, n), end = min(begin + run, n);
  const int end4 = n % 4 ? begin : end;  // rows of inputs are multiples of 16 bytes or not
  for (int group = get_group_id(0); group * group_tiles < n_tiles; group += get_num_groups(0)) {
    const int tile = group * group_tiles + id % group_tiles;
    const int lane = tile % n_lanes, first = min(tile / n_lanes * PIXELS, n_pixels - 1);
    global const float* restrict w = weights + op.weight_offset + lane / 4 * n * NN_PANEL + lane % 4 * 4;
    global const float* x0 = arena + op.in_offset + first * n;
    global const float* x1 = arena + op.in_offset + min(first + 1, n_pixels - 1) * n;
    global const float* x2 = arena + op.in_offset + min(first + 2, n_pixels - 1) * n;
    global const float* x3 = arena + op.in_offset + min(first + 3, n_pixels - 1) * n;
    float4 a0 = 0.0f, a1 = 0.0f, a2 = 0.0f, a3 = 0.0f;
    int k = begin;
#pragma unroll 4
    for (; k < end4; k += 4) {
      const float4 p0 = load_aligned(x0 + k), p1 = load_aligned(x1 + k);
      const float4 p2 = load_aligned(x2 + k), p3 = load_aligned(x3 + k);
      const float4 w0 = load_aligned(w + k * NN_PANEL), w1 = load_aligned(w + (k + 1) * NN_PANEL);
      const float4 w2 = load_aligned(w + (k + 2) * NN_PANEL), w3 = load_aligned(w + (k + 3) * NN_PANEL);
      a0 += p0.x * w0;
      a1 += p1.x * w0;
      a2 += p2.x * w0;
      a3 += p3.x * w0;
      a0 += p0.y * w1;
      a1 += p1.y * w1;
      a2 += p2.y * w1;
      a3 += p3.y * w1;
      a0 += p0.z * w2;
      a1 += p1.z * w2;
      a2 += p2.z * w2;
      a3 += p3.z * w2;
      a0 += p0.w * w3;
      a1 += p1.w * w3;
      a2 += p2.w * w3;
      a3 += p3.w * w3;
    }
    for (; k < end; ++k) {
      const float4 wk = load_aligned(w + k * NN_PANEL);
      a0 += x0[k] * wk;
      a1 += x1[k] * wk;
      a2 += x2[k] * wk;
      a3 += x3[k] * wk;
    }
    if (slices > 1) {
      barrier(CLK_LOCAL_MEM_FENCE);
      sums[id] = a0;
      sums[NN_GROUP + id] = a1;
      sums[2 * NN_GROUP + id] = a2;
      sums[3 * NN_GROUP + id] = a3;
      barrier(CLK_LOCAL_MEM_FENCE);
    }
    // One pixel's sum a work-item and turn.
    for (int i = id; i < PIXELS * group_tiles; i += NN_GROUP) {
      const int part = i / group_tiles, of = group * group_tiles + i % group_tiles;
      const int pixel = of / n_lanes * PIXELS + part, channel = of % n_lanes * 4;
      float4 sum = load_aligned(weights + op.bias_offset + channel);
      if (slices > 1) {
        for (int s = 0; s < slices; ++s) sum += sums[part * NN_GROUP + s * group_tiles + i % group_tiles];
      } else {
        sum += part == 0 ? a0 : part == 1 ? a1 : part == 2 ? a2 : a3;
      }
      if (of < n_tiles && pixel < n_pixels) store4(op, arena, pixel, channel, sum);
    }
  }
}

// Any convolution, a pixel x 4 channels a tile; each slice sums every `slices`-th input channel of each tap.
static void window(NnOp op, int slices, global const float* restrict weights, global float* arena, local float4* sums) {
  const int id = get_local_id(0);
  const int group_tiles = NN_GROUP / slices;
  const int slice = id / group_tiles;
  const int n_lanes = (op.out_channels + 3) / 4;
  const int n_tiles = op.out_height * op.out_width * n_lanes;
  const int channels = op.in_channels;
  for (int group = get_group_id(0); group * group_tiles < n_tiles; group += get_num_groups(0)) {
    const int tile = min(group * group_tiles + id % group_tiles, n_tiles - 1);
    const int lane = tile % n_lanes, pixel = tile / n_lanes;
    float4 sum = 0.0f;
    for (int ky = 0; ky < op.kernel_h; ++ky) {
      const int in_y = pixel / op.out_width * op.stride_h - op.pad_top + ky * op.dilation_h;
      if (in_y < 0 || in_y >= op.in_height) continue;
      for (int kx = 0; kx < op.kernel_w; ++kx) {
        const int in_x = pixel % op.out_width * op.stride_w - op.pad_left + kx * op.dilation_w;
        if (in_x < 0 || in_x >= op.in_width) continue;
        global const float* x = arena + op.in_offset + (in_y * op.in_width + in_x) * channels;
        global const float* restrict w = weights + op.weight_offset +
                                         ((lane / 4 * op.kernel_h + ky) * op.kernel_w + kx) * channels * NN_PANEL +
                                         lane % 4 * 4;
#pragma unroll 4
        for (int k = slice; k < channels; k += slices) sum += x[k] * load_aligned(w + k * NN_PANEL);
      }
    }
    if (slices > 1) {
      barrier(CLK_LOCAL_MEM_FENCE);
      sums[id] = sum;
      barrier(CLK_LOCAL_MEM_FENCE);
      if (id < group_tiles) {
        for (int s = 1; s < slices; ++s) sum += sums[s * group_tiles + id];
      }
    }
    if (id < group_tiles && group * group_tiles + id < n_tiles)
      store4(op, arena, pixel, lane * 4, sum + load_aligned(weights + op.bias_offset + lane * 4));
  }
}

// Taps of a row of a window, read at once: those outside the image from inside it, then not counted. KW 0: any width.
#define DEPTHWISE_ROW(KW)                                                                                     \
  _Pragma("unroll") for (int kx = 0; kx < (KW ? KW : op.kernel_w); ++kx) {                                    \
    const int in_x = x0 + kx * op.dilation_w;                                                                 \
    const float4 v = load_aligned(row + clamp(in_x, 0, op.in_width - 1) * op.in_channels);                    \
    const float4 counts = in_x >= 0 && in_x < op.in_width ? load_aligned(w + kx * NN_PANEL) : (float4)(0.0f); \
    sum += v * counts;                                                                                        \
  }

// Four channels of a pixel a work-item.
static void depthwise(NnOp op, global const float* restrict weights, global float* arena) {
  const int n_lanes = op.out_channels / 4;
  const int count = op.out_height * op.out_width * n_lanes;
  for (int i = get_global_id(0); i < count; i += get_global_size(0)) {
    const int pixel = i / n_lanes, channel = i % n_lanes * 4;
    const int x0 = pixel % op.out_width * op.stride_w - op.pad_left;
    const int y0 = pixel / op.out_width * op.stride_h - op.pad_top;
    float4 sum = load_aligned(weights + op.bias_offset + channel);
    global const float* restrict w =
        weights + op.weight_offset + channel / NN_PANEL * op.kernel_h * op.kernel_w * NN_PANEL + channel % NN_PANEL;
    for (int ky = 0; ky < op.kernel_h; ++ky, w += op.kernel_w * NN_PANEL) {
      const int in_y = y0 + ky * op.dilation_h;
      if (in_y < 0 || in_y >= op.in_height) continue;
      global const float* row = arena + op.in_offset + in_y * op.in_width * op.in_channels + channel;
      if (op.kernel_w == 3) {
        DEPTHWISE_ROW(3)
      } else if (op.kernel_w == 5) {
        DEPTHWISE_ROW(5)
      } else {
        DEPTHWISE_ROW(0)
      }
    }
    store4(op, arena, pixel, channel, sum);
  }
}

// Channels that are no multiple of four: one element a work-item.
static void depthwise_any(NnOp op, global const float* restrict weights, global float* arena) {
  const int taps = op.kernel_h * op.kernel_w;
  for (int i = get_global_id(0); i < op.out_height * op.out_width * op.out_channels; i += get_global_size(0)) {
    const int pixel = i / op.out_channels, c = i % op.out_channels;
    global const float* restrict w = weights + op.weight_offset + c / NN_PANEL * taps * NN_PANEL + c % NN_PANEL;
    float sum = weights[op.bias_offset + c];
    for (int ky = 0; ky < op.kernel_h; ++ky) {
      const int in_y = pixel / op.out_width * op.stride_h - op.pad_top + ky * op.dilation_h;
      if (in_y < 0 || in_y >= op.in_height) continue;
      for (int kx = 0; kx < op.kernel_w; ++kx) {
        const int in_x = pixel % op.out_width * op.stride_w - op.pad_left + kx * op.dilation_w;
        if (in_x < 0 || in_x >= op.in_width) continue;
        sum += arena[op.in_offset + (in_y * op.in_width + in_x) * op.in_channels + c] *
               w[(ky * op.kernel_w + kx) * NN_PANEL];
      }
    }
    nn_store(op, arena, i, sum);
  }
}

static float resized(NnOp op, global const float* arena, int i) {
  const int pixel = i / op.out_channels;
  const NnSample sx = nn_sample(op, pixel % op.out_width, op.in_width, op.out_width);
  const NnSample sy = nn_sample(op, pixel / op.out_width, op.in_height, op.out_height);
  global const float* image = arena + op.in_offset + i % op.out_channels;
  const float v00 = image[(sy.i0 * op.in_width + sx.i0) * op.in_channels];
  const float v01 = image[(sy.i0 * op.in_width + sx.i1) * op.in_channels];
  const float v10 = image[(sy.i1 * op.in_width + sx.i0) * op.in_channels];
  const float v11 = image[(sy.i1 * op.in_width + sx.i1) * op.in_channels];
  const float top = v00 + sx.t * (v01 - v00);
  const float bottom = v10 + sx.t * (v11 - v10);
  return top + sy.t * (bottom - top);
}

// Layers of which a work-item makes one element.
static void elements(NnOp op, int kind, global float* arena) {
  const int count = op.out_height * op.out_width * op.out_channels;
  for (int i = get_global_id(0); i < count; i += get_global_size(0)) {
    if (kind == NN_RESIZE) {
      nn_store(op, arena, i, resized(op, arena, i));
    } else if (kind == NN_MAX_POOL) {
      nn_store(op, arena, i, nn_largest(op, arena, i));
    } else if (kind == NN_ADD) {
      nn_store(op, arena, i, arena[op.in_offset + i]);
    } else {
      arena[op.out_offset + i] = 1.0f / (1.0f + exp(-arena[op.in_offset + i]));
    }
  }
}

// Layers first..end-1, in work-groups of NN_GROUP. arrived: state[0] before the launch.
kernel __attribute__((reqd_work_group_size(NN_GROUP, 1, 1))) void run_layers(int first, int end, int arrived,
                                                                             global const int* restrict layers,
                                                                             global const float* restrict weights,
                                                                             global float* arena,
                                                                             volatile global int* state) {
  local float4 sums[PIXELS * NN_GROUP];
  local NnLayer layer;
  local int given_up;
  const int words = sizeof(NnLayer) / sizeof(int);
  for (int i = first; i < end; ++i) {
    if (i > first) {
      arrived += get_num_groups(0);
      if (!all_arrived(1, state, arrived, &given_up)) return;
    }
    for (int k = get_local_id(0); k < words; k += NN_GROUP) ((local int*)&layer)[k] = layers[i * words + k];
    barrier(CLK_LOCAL_MEM_FENCE);
    const NnOp op = layer.op;
    const int kind = layer.kind;
    if (kind == NN_POINTWISE) {
      pointwise(op, layer.slices, weights, arena, sums);
    } else if (kind == NN_WINDOW) {
      window(op, layer.slices, weights, arena, sums);
    } else if (kind == NN_DEPTHWISE_LAYER && op.out_channels % 4 == 0) {
      depthwise(op, weights, arena);
    } else if (kind == NN_DEPTHWISE_LAYER) {
      depthwise_any(op, weights, arena);
    } else {
      elements(op, kind, arena);
    }
  }
}
