// Where RESIZE_BILINEAR looks for an output row or column.
#ifndef LC_NN_RESIZE_SAMPLE_H
#define LC_NN_RESIZE_SAMPLE_H
#include "nn/op_params.h"
#include "shared/plain_math.h"

typedef struct {
  int i0, i1;  // the two neighbours, inside the image
  float t;     // weight of i1
} NnSample;

static inline NnSample nn_sample(NnOp op, int i, int in_size, int out_size) {
  const float scale = op.align_corners && out_size > 1 ? (float)(in_size - 1) / (float)(out_size - 1)
                                                       : (float)in_size / (float)out_size;
  const float at = op.half_pixel_centers ? ((float)i + 0.5f) * scale - 0.5f : (float)i * scale;
  const float below = LC_FLOOR(at);
  NnSample s;
  s.t = at - below;
  s.i0 = clamp((int)below, 0, in_size - 1);
  s.i1 = clamp((int)below + 1, 0, in_size - 1);
  return s;
}

#endif
