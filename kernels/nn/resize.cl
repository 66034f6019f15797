// RESIZE_BILINEAR, NHWC. On a CPU one work-item is one output row, on a GPU one output element.
#include "nn/panel.h"

typedef struct {
  int i0, i1;  // the two neighbours, inside the image
  float t;     // weight of i1
} NnSample;

static inline NnSample nn_sample(NnOp op, int i, int in_size, int out_size) {
  const float scale = op.align_corners && out_size > 1 ? (float)(in_size - 1) / (float)(out_size - 1)
                                                       : (float)in_size / (float)out_size;
  const float at = op.half_pixel_centers ? ((float)i + 0.5f) * scale - 0.5f : (float)i * scale;
  const float below = floor(at);
  NnSample s;
  s.t = at - below;
  s.i0 = clamp((int)below, 0, in_size - 1);
  s.i1 = clamp((int)below + 1, 0, in_size - 1);
  return s;
}

#if LC_CPU

// count = rows.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void resize_bilinear(NnOp op, global float* arena) {
  const int y = get_global_id(0);
  if (y >= op.count) return;
  const int channels = op.in_channels;
  const NnSample sy = nn_sample(op, y, op.in_height, op.out_height);
  const int row0 = op.in_offset + sy.i0 * op.in_width * channels;
  const int row1 = op.in_offset + sy.i1 * op.in_width * channels;
  for (int x = 0; x < op.out_width; ++x) {
    const NnSample sx = nn_sample(op, x, op.in_width, op.out_width);
    const int left = sx.i0 * channels;
    const int right = sx.i1 * channels;
    for (int c = 0; c < channels; c += NN_PANEL) {
      const float16 v00 = vload16(0, arena + row0 + left + c);
      const float16 v01 = vload16(0, arena + row0 + right + c);
      const float16 v10 = vload16(0, arena + row1 + left + c);
      const float16 v11 = vload16(0, arena + row1 + right + c);
      const float16 top = sx.t * (v01 - v00) + v00;
      const float16 bottom = sx.t * (v11 - v10) + v10;
      nn_store_panel(op, arena, (y * op.out_width + x) * channels + c, sy.t * (bottom - top) + top, channels - c);
    }
  }
}

#else

// count = elements.
kernel void resize_bilinear(NnOp op, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int c = id % op.out_channels;
  const int pixel = id / op.out_channels;
  const NnSample sx = nn_sample(op, pixel % op.out_width, op.in_width, op.out_width);
  const NnSample sy = nn_sample(op, pixel / op.out_width, op.in_height, op.out_height);
  global const float* image = arena + op.in_offset + c;
  const float v00 = image[(sy.i0 * op.in_width + sx.i0) * op.in_channels];
  const float v01 = image[(sy.i0 * op.in_width + sx.i1) * op.in_channels];
  const float v10 = image[(sy.i1 * op.in_width + sx.i0) * op.in_channels];
  const float v11 = image[(sy.i1 * op.in_width + sx.i1) * op.in_channels];
  const float top = v00 + sx.t * (v01 - v00);
  const float bottom = v10 + sx.t * (v11 - v10);
  nn_store(op, arena, id, top + sy.t * (bottom - top));
}

#endif
