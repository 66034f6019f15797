// The camera's pyramid in one go, on GPUs.
#ifndef LC_MATCH_CAMERA_BLOCK_H
#define LC_MATCH_CAMERA_BLOCK_H
#include "shared/luminance.h"

// What camera_picture and halve_picture make of 4 x 4 pixels, of all levels, which follow each other: the same to the
// bit, to which tests/match/actor_sight_test.cpp holds it. There a work-item has a row of pixels, here all levels of a
// block in registers. block: in rows of box.width / 4. box: of level 0.
static inline void camera_block(int block, MatchBox box, int width, int height, global const uchar* restrict rgb,
                                global const float* restrict signed_distance, global float* restrict light,
                                global float* restrict weight) {
  const int bx = block % (box.width / 4), by = block / (box.width / 4);
  float lights[4][4], counts[4][4];
#pragma unroll
  for (int r = 0; r < 4; ++r) {
    const int y = box.y + 4 * by + r, at = (4 * by + r) * box.width + 4 * bx;
#pragma unroll
    for (int k = 0; k < 4; ++k) {
      const int x = box.x + 4 * bx + k;
      const int inside = x >= 0 && x < width && y >= 0 && y < height;
      const int p = inside ? y * width + x : 0;
      const int person = inside && signed_distance[p] < 0.0f;
      const float bright = luminance(rgb[3 * p], rgb[3 * p + 1], rgb[3 * p + 2]) * (1.0f / 255.0f);
      lights[r][k] = person ? bright : 0.0f;
      counts[r][k] = person ? 1.0f : 0.0f;
      light[at + k] = lights[r][k];
      weight[at + k] = counts[r][k];
    }
  }
  int side = 4, level_width = box.width, offset = 0, level_height = box.height;
#pragma unroll
  for (int level = 1; level <= 2; ++level) {
    offset += level_width * level_height;
    level_width /= 2;
    level_height /= 2;
    side /= 2;
#pragma unroll
    for (int r = 0; r < side; ++r) {
#pragma unroll
      for (int k = 0; k < side; ++k) {
        const float sum = (lights[2 * r][2 * k] + lights[2 * r + 1][2 * k]) +
                          (lights[2 * r][2 * k + 1] + lights[2 * r + 1][2 * k + 1]);
        const float n = (counts[2 * r][2 * k] + counts[2 * r + 1][2 * k]) +
                        (counts[2 * r][2 * k + 1] + counts[2 * r + 1][2 * k + 1]);
        const int at = offset + (side * by + r) * level_width + side * bx + k;
        lights[r][k] = n >= 2.0f ? sum / n : 0.0f;
        counts[r][k] = n >= 2.0f ? 1.0f : 0.0f;
        light[at] = lights[r][k];
        weight[at] = counts[r][k];
      }
    }
  }
}

#endif
