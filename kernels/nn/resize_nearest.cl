// RESIZE_NEAREST, NHWC. One work-item = one output element.
#include "nn/panel.h"

// The source position is a fraction of whole numbers, so that no rounding decides between two pixels.
static inline int nn_floor_divide(int a, int b) {  // b > 0
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

static inline int nn_nearest(NnOp op, int i, int in_size, int out_size) {
  const int corners = op.align_corners && out_size > 1;
  const int from = corners ? in_size - 1 : in_size;
  const int to = corners ? out_size - 1 : out_size;
  const int a = op.half_pixel_centers ? (2 * i + 1) * from - to : 2 * i * from;  // position = a / b
  const int b = 2 * to;
  const int at = op.mode == 0   ? nn_floor_divide(a, b)
                 : op.mode == 1 ? -nn_floor_divide(-a, b)
                 : op.mode == 2 ? -nn_floor_divide(to - a, b)
                                : nn_floor_divide(a + to, b);
  return clamp(at, 0, in_size - 1);
}

// count = elements.
kernel void resize_nearest(NnOp op, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int c = id % op.out_channels;
  const int pixel = id / op.out_channels;
  const int x = nn_nearest(op, pixel % op.out_width, op.in_width, op.out_width);
  const int y = nn_nearest(op, pixel / op.out_width, op.in_height, op.out_height);
  nn_store(op, arena, id, arena[op.in_offset + (y * op.in_width + x) * op.in_channels + c]);
}
