// Affine warps as OpenCV 4.6 makes them, to the bit: positions in 1024ths, rounded to 32nds of a pixel.
#ifndef LC_IMAGE_WARP_POINT_H
#define LC_IMAGE_WARP_POINT_H

typedef struct {
  int x, y;    // the pixel
  int fx, fy;  // 32nds from there
} WarpPoint;

// steps: of src/image/affine_warp.h:fixed_steps, for `width` columns.
static inline WarpPoint warp_point(global const int* restrict steps, int width, int x, int y) {
  global const int* restrict rows = steps + 2 * width;
  const int at_x = (steps[2 * x] + rows[2 * y]) >> 5, at_y = (steps[2 * x + 1] + rows[2 * y + 1]) >> 5;
  const WarpPoint p = {at_x >> 5, at_y >> 5, at_x & 31, at_y & 31};
  return p;
}

// Bilinear mean of the pixel, the one beside it, and those below.
static inline int warp_mix(WarpPoint p, int v00, int v01, int v10, int v11) {
  const int top = v00 * (32 - p.fx) + v01 * p.fx, bottom = v10 * (32 - p.fx) + v11 * p.fx;
  return (top * (32 - p.fy) + bottom * p.fy + 512) >> 10;
}

#endif
