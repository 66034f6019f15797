// Means and maxima over an image or over its channels. One work-item = one output element or pixel.
#include "nn/panel.h"
#include "nn/pool_window.h"

// Mean over the window's pixels inside the image; mode 1: over all of it, zeros outside. count = elements.
kernel void average_pool(NnOp op, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  const int c = id % op.out_channels;
  const NnPoolWindow window = nn_pool_window(op, id / op.out_channels);
  float sum = 0.0f;
  for (int y = window.top; y < window.bottom; ++y) {  // rows first: a sum over a whole image keeps its digits
    float row = 0.0f;
    for (int x = window.left; x < window.right; ++x)
      row += arena[op.in_offset + (y * op.in_width + x) * op.in_channels + c];
    sum += row;
  }
  const int area = op.mode ? op.kernel_h * op.kernel_w : (window.bottom - window.top) * (window.right - window.left);
  nn_store(op, arena, id, sum / (float)area);
}

// count = elements.
kernel void max_pool(NnOp op, global float* arena) {
  const int id = get_global_id(0);
  if (id >= op.count) return;
  nn_store(op, arena, id, nn_largest(op, arena, id));
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
