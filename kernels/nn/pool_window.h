// The part of a pooling window that lies inside the image.
#ifndef LC_NN_POOL_WINDOW_H
#define LC_NN_POOL_WINDOW_H
#include "nn/op_params.h"

typedef struct {
  int left, right, top, bottom;  // pixels of the input; right and bottom are behind the last
} NnPoolWindow;

static inline NnPoolWindow nn_pool_window(NnOp op, int pixel) {
  const int x = pixel % op.out_width * op.stride_w - op.pad_left;
  const int y = pixel / op.out_width * op.stride_h - op.pad_top;
  NnPoolWindow window;
  window.left = max(x, 0);
  window.right = min(x + op.kernel_w, op.in_width);
  window.top = max(y, 0);
  window.bottom = min(y + op.kernel_h, op.in_height);
  return window;
}

// Largest value in the window of an output element; pixels outside the image are left out.
static inline float nn_largest(NnOp op, global const float* arena, int element) {
  const NnPoolWindow window = nn_pool_window(op, element / op.out_channels);
  float best = -INFINITY;
  for (int y = window.top; y < window.bottom; ++y) {
    for (int x = window.left; x < window.right; ++x)
      best = fmax(best, arena[op.in_offset + (y * op.in_width + x) * op.in_channels + element % op.out_channels]);
  }
  return best;
}

#endif
