// RESIZE_BILINEAR, NHWC, on CPUs (GPUs: layers.cl). One work-item = one output row. count = rows.
#include "nn/panel.h"
#include "nn/resize_sample.h"

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
    const int at = (y * op.out_width + x) * channels;
    int c = 0;
    for (; c + NN_PANEL / 2 < channels; c += NN_PANEL) {
      const float16 v00 = vload16(0, arena + row0 + left + c);
      const float16 v01 = vload16(0, arena + row0 + right + c);
      const float16 v10 = vload16(0, arena + row1 + left + c);
      const float16 v11 = vload16(0, arena + row1 + right + c);
      const float16 top = sx.t * (v01 - v00) + v00;
      const float16 bottom = sx.t * (v11 - v10) + v10;
      nn_store_panel(op, arena, at + c, sy.t * (bottom - top) + top, channels - c);
    }
    if (c < channels) {  // half a panel at most
      const float8 v00 = vload8(0, arena + row0 + left + c);
      const float8 v01 = vload8(0, arena + row0 + right + c);
      const float8 v10 = vload8(0, arena + row1 + left + c);
      const float8 v11 = vload8(0, arena + row1 + right + c);
      const float8 top = sx.t * (v01 - v00) + v00;
      const float8 bottom = sx.t * (v11 - v10) + v10;
      nn_store_half(op, arena, at + c, sy.t * (bottom - top) + top, channels - c);
    }
  }
}
