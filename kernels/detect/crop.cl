// What surrounds a pose network on a GPU: its input out of the picture, and what is read of its outputs. The same as
// src/detect/crop.cpp and src/detect/blazepose.cpp on the host.
#include "detect/layout.h"
#include "image/warp_point.h"

// The picture's part that is looked at, in blocks of factor x factor pixels from (x0, y0) on.
typedef struct {
  int picture_width;
  int x0, y0;
  int width, height;  // blocks
  int factor;
  float share;  // 1 / factor^2
} Blocks;

// Mean of a channel over a block, 0 outside; rounded as OpenCV does it.
static int block(global const uchar* restrict picture, Blocks b, int x, int y, int channel) {
  if (x < 0 || y < 0 || x >= b.width || y >= b.height) return 0;
  global const uchar* restrict p =
      picture + 3 * ((b.y0 + y * b.factor) * b.picture_width + b.x0 + x * b.factor) + channel;
  int sum = 0;
  for (int i = 0; i < b.factor; ++i) {
    for (int j = 0; j < b.factor; ++j) sum += p[3 * (i * b.picture_width + j)];
  }
  return b.factor == 2 ? (sum + 2) >> 2 : convert_int_rte((float)sum * b.share);
}

// Over (size, size). picture [3*w*h]; steps: from crop to blocks. Out: input [3*size*size] from `at` on, 0..1.
kernel void crop_picture(int size, int mirrored, Blocks blocks, int at, global const uchar* restrict picture,
                         global const int* restrict steps, global float* restrict input) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= size || y >= size) return;
  const WarpPoint p = warp_point(steps, size, x, y);
  for (int c = 0; c < 3; ++c) {
    const int value = warp_mix(p, block(picture, blocks, p.x, p.y, c), block(picture, blocks, p.x + 1, p.y, c),
                               block(picture, blocks, p.x, p.y + 1, c), block(picture, blocks, p.x + 1, p.y + 1, c));
    input[at + 3 * (y * size + (mirrored ? size - 1 - x : x)) + c] = (1.0f / 255) * (float)value;
  }
}

// Over LC_LANDMARKS * LC_WINDOW^2. Offsets of landmarks, score, heat maps and world points. Out: [5*LC_LANDMARKS]
// landmarks, the score, [3*LC_LANDMARKS] world points, and of each heat map the window around its landmark, 0 outside.
kernel void pose_outputs(int4 offsets, global const float* restrict arena, global float* restrict out) {
  const int i = get_global_id(0);
  if (i >= LC_LANDMARKS * LC_WINDOW * LC_WINDOW) return;
  global const float* landmarks = arena + offsets.x;
  if (i < 5 * LC_LANDMARKS) out[i] = landmarks[i];
  if (i == 0) out[5 * LC_LANDMARKS] = arena[offsets.y];
  if (i < 3 * LC_LANDMARKS) out[5 * LC_LANDMARKS + 1 + i] = arena[offsets.w + i];
  const int l = i / (LC_WINDOW * LC_WINDOW), k = i % (LC_WINDOW * LC_WINDOW);
  const float scale = (float)LC_HEATMAP / LC_CROP;
  // NaN and what is far away: any window.
  const float px = landmarks[5 * l] * scale, py = landmarks[5 * l + 1] * scale;
  const int inside = px >= 0.0f && py >= 0.0f && px < (float)LC_HEATMAP && py < (float)LC_HEATMAP;
  const int x = (inside ? (int)px : 0) + k % LC_WINDOW - LC_WINDOW / 2,
            y = (inside ? (int)py : 0) + k / LC_WINDOW - LC_WINDOW / 2;
  out[8 * LC_LANDMARKS + 1 + i] = x >= 0 && y >= 0 && x < LC_HEATMAP && y < LC_HEATMAP
                                      ? arena[offsets.z + (y * LC_HEATMAP + x) * LC_LANDMARKS + l]
                                      : 0.0f;
}

// Over LC_CROP^2: probabilities from logits, 255 = 1.
kernel void mask_bytes(int at, int mirrored, global const float* restrict arena, global uchar* restrict mask) {
  const int i = get_global_id(0);
  if (i >= LC_CROP * LC_CROP) return;
  const int from = mirrored ? i / LC_CROP * LC_CROP + LC_CROP - 1 - i % LC_CROP : i;
  mask[i] = (uchar)(255.0f / (1.0f + exp(-arena[at + from])) + 0.5f);
}
