// Means and maxima over an image or over its channels. One work-item = one output element or pixel.
#include "nn/panel.h"

// Mean over the window's pixels inside the image; mode 1: over all of it, zeros outside. count = elements.
kernel void average_pool(NnOp op, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int c = id % op.out_channels;
  const int pixel = id / op.out_channels;
  const int in_x = pixel % op.out_width * op.stride_w - op.pad_left;
  const int in_y = pixel / op.out_width * op.stride_h - op.pad_top;
  const int top = max(in_y, 0), bottom = min(in_y + op.kernel_h, op.in_height);
  const int left = max(in_x, 0), right = min(in_x + op.kernel_w, op.in_width);
  float sum = 0.0f;
  for (int y = top; y < bottom; ++y) {  // rows first: a sum over a whole image keeps its digits
    float row = 0.0f;
    for (int x = left; x < right; ++x) row += arena[op.in_offset + (y * op.in_width + x) * op.in_channels + c];
    sum += row;
  }
  const int area = op.mode ? op.kernel_h * op.kernel_w : (bottom - top) * (right - left);
  nn_store(op, arena, id, sum / (float)area);
}

// exp(x) over its sum over the channels. count = pixels.
kernel void softmax(NnOp op, global float* arena) {
  const int pixel = get_global_id(0);
  if (pixel >= op.count) return;
  const int n = op.in_channels;
  global const float* x = arena + op.in_offset + pixel * n;
  float largest = x[0];
  for (int c = 1; c < n; ++c) largest = fmax(largest, x[c]);
  float sum = 0.0f;
  for (int c = 0; c < n; ++c) sum += exp(x[c] - largest);
  for (int c = 0; c < n; ++c) nn_store(op, arena, pixel * n + c, exp(x[c] - largest) / sum);
}

// The first channel with the largest value. count = pixels.
kernel void arg_max(NnOp op, global float* arena) {
  const int pixel = get_global_id(0);
  if (pixel >= op.count) return;
  global const float* x = arena + op.in_offset + pixel * op.in_channels;
  int best = 0;
  for (int c = 1; c < op.in_channels; ++c) {
    if (x[c] > x[best]) best = c;
  }
  nn_store(op, arena, pixel, (float)best);
}
