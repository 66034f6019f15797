// [J | F]^T [J | F] in 8x8 tiles of the upper triangle: J^T J and J^T F at once, rows summed in fixed order.
// Tile t = (tile row a, tile column b >= a), counted along the rows.
#include "pose/layout.h"

// The tile's place, as first column of its rows and of its columns.
inline int2 tile_corner(int tile, int n_tiles_per_side) {
  int a = 0;
  while (tile >= n_tiles_per_side - a) {
    tile -= n_tiles_per_side - a;
    ++a;
  }
  return (int2)(8 * a, 8 * (a + tile));
}

#if LC_CPU

// One work-item per tile, of which every fourth makes four with the sums in registers. J [n_rows*n_columns]. Out: gram
// [n_tiles][8][8].
kernel void pose_gram(int n_tiles, int n_rows, int n_columns, global const float* restrict J,
                      global float* restrict gram) {
  const int block = get_global_id(0);
  if (block >= n_tiles) return;
  const int2 corner = tile_corner(block, n_columns / 8);
  // Four tiles at once: 16 x 16 entries, those below the diagonal for nothing.
  if (corner.x % 16 || corner.y % 16) return;
  float16 s0 = 0.0f, s1 = 0.0f, s2 = 0.0f, s3 = 0.0f, s4 = 0.0f, s5 = 0.0f, s6 = 0.0f, s7 = 0.0f;
  float16 s8 = 0.0f, s9 = 0.0f, sa = 0.0f, sb = 0.0f, sc = 0.0f, sd = 0.0f, se = 0.0f, sf = 0.0f;
  for (int row = 0; row < n_rows; ++row) {
    global const float* left = J + row * n_columns + corner.x;
    const float16 right = vload16(0, J + row * n_columns + corner.y);
    s0 += left[0] * right;
    s1 += left[1] * right;
    s2 += left[2] * right;
    s3 += left[3] * right;
    s4 += left[4] * right;
    s5 += left[5] * right;
    s6 += left[6] * right;
    s7 += left[7] * right;
    s8 += left[8] * right;
    s9 += left[9] * right;
    sa += left[10] * right;
    sb += left[11] * right;
    sc += left[12] * right;
    sd += left[13] * right;
    se += left[14] * right;
    sf += left[15] * right;
  }
  const float16 upper[8] = {s0, s1, s2, s3, s4, s5, s6, s7}, lower[8] = {s8, s9, sa, sb, sc, sd, se, sf};
  global float* out = gram + 64 * block;
  // The tile below the first one, which exists right of the diagonal only, and the one beside it.
  const int below = block + (n_columns - corner.x) / 8 - 1;
  global float* out_below = gram + 64 * below;
  for (int k = 0; k < 8; ++k) {
    vstore8(upper[k].lo, k, out);
    vstore8(upper[k].hi, 8 + k, out);
    if (corner.y > corner.x) vstore8(lower[k].lo, k, out_below);
    vstore8(lower[k].hi, 8 + k, out_below);
  }
}

#endif
