// CONV_2D on GPUs where the output is small and the sums are long: a work-group of 64 shares one pixel x NN_PANEL
// channels. Each of 16 slices sums every 16th input channel of every tap, the slices are added as a tree: the order is
// fixed.
#include "nn/panel.h"

#define NN_LANES 4  // work-items of one panel, 4 channels each
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
  const int channels = op.in_channels;
  const int lane = panel * NN_LANES + id % NN_LANES;
  float4 sum = (float4)(0.0f);
  for (int ky = 0; ky < op.kernel_h; ++ky) {
    const int in_y = pixel / op.out_width * op.stride_h - op.pad_top + ky * op.dilation_h;
    if (in_y < 0 || in_y >= op.in_height) continue;
    for (int kx = 0; kx < op.kernel_w; ++kx) {
      const int in_x = pixel % op.out_width * op.stride_w - op.pad_left + kx * op.dilation_w;
      if (in_x < 0 || in_x >= op.in_width) continue;
      global const float* x = arena + op.in_offset + (in_y * op.in_width + in_x) * channels;
      global const float* restrict w = weights + op.weight_offset +
                                       ((panel * op.kernel_h + ky) * op.kernel_w + kx) * channels * NN_PANEL +
                                       id % NN_LANES * 4;
      for (int k = slice; k < channels; k += NN_SLICES) sum = nn_broadcast_mad(x[k], vload4(0, w + k * NN_PANEL), sum);
    }
  }
  sums[id] = sum;
  for (int half_size = NN_SLICES / 2; half_size > 0; half_size /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (slice < half_size) sums[id] += sums[id + half_size * NN_LANES];
  }
  if (slice == 0) nn_store4(op, arena, pixel, lane * 4, sums[id] + vload4(lane, weights + op.bias_offset));
}
