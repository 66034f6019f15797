// CONV_2D on GPUs where the output is small and the sums are long: a work-group of 64 shares one pixel x NN_PANEL
// channels. Each of 16 slices sums every 16th input channel of every tap, the slices are added as a tree: the order is
// fixed.
#include "nn/panel.h"

#define NN_SLICES 16

// count = pixels * panels * 64, work-groups of 64.
kernel __attribute__((reqd_work_group_size(NN_LANES * NN_SLICES, 1, 1))) void conv_split(
    NnOp op, global const float* restrict weights, global float* arena) {
  local float4 sums[NN_LANES * NN_SLICES];
  const int id = get_local_id(0);
  const int slice = id / NN_LANES;
  const int n_panels = (op.out_channels + NN_PANEL - 1) / NN_PANEL;
  const int panel = get_group_id(0) % n_panels;
  const int pixel = get_group_id(0) / n_panels;
  const int lane = panel * NN_LANES + id % NN_LANES;
  sums[id] = nn_window_sum(op, weights, arena, pixel, lane, slice, NN_SLICES, (float4)(0.0f));
  for (int half_size = NN_SLICES / 2; half_size > 0; half_size /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (slice < half_size) sums[id] += sums[id + half_size * NN_LANES];
  }
  if (slice == 0) nn_store4(op, arena, pixel, lane * 4, sums[id] + vload4(lane, weights + op.bias_offset));
}
