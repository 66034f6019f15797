// Looking up images at projected positions (px, pixel centres at integers).
#ifndef LC_SURFACE_IMAGE_H
#define LC_SURFACE_IMAGE_H
#include "shared/camera.h"
#include "shared/distance_sample.h"
#include "shared/plain_math.h"

// False for NaN.
static inline int inside_image(Vec2 uv, int width, int height) {
  return uv.x >= -0.5f && uv.y >= -0.5f && uv.x <= width - 0.5f && uv.y <= height - 0.5f;
}

// uv must be inside the image, which is at least 2x2.
static inline DistanceSample sample_distance(global const float* restrict distance, int width, int height, Vec2 uv) {
  int x = clamp((int)LC_FLOOR(uv.x), 0, width - 2);
  int y = clamp((int)LC_FLOOR(uv.y), 0, height - 2);
  global const float* d = distance + (size_t)y * width + x;
  return distance_sample(d[0], d[1], d[width], d[width + 1], uv.x - x, uv.y - y);
}

// True when uv lies on the region of another body part: 0 in the image is background, which belongs to nobody.
static inline int on_other_part(global const uchar* restrict part_image, int width, int height, Vec2 uv, int part) {
  int x = clamp((int)LC_RINT(uv.x), 0, width - 1);
  int y = clamp((int)LC_RINT(uv.y), 0, height - 1);
  int there = part_image[(size_t)y * width + x];
  return there != 0 && there != part;
}

// Image direction of a camera-frame direction at a projected point.
static inline Vec2 project_direction(Projection q, Vec3 n) {
  Vec2 out = {q.J[0][0] * n.x + q.J[0][1] * n.y + q.J[0][2] * n.z, q.J[1][0] * n.x + q.J[1][1] * n.y + q.J[1][2] * n.z};
  return out;
}

#endif
