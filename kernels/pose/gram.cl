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

// Of sixteen sums over rows as many at a time as the registers hold, over rows that stay in the nearest cache.
#if LC_VECTOR == 16
#define SUMS 16
#define ROWS INT_MAX
#else
#define SUMS 4
#define ROWS 128
#endif

// One work-item per tile, of which every fourth makes four. J [n_rows*n_columns]. Out: gram [n_tiles][8][8].
kernel void pose_gram(int n_tiles, int n_rows, int n_columns, global const float* restrict J,
                      global float* restrict gram) {
  const int block = get_global_id(0);
  if (block >= n_tiles) return;
  const int2 corner = tile_corner(block, n_columns / 8);
  // Four tiles at once: 16 x 16 entries, those below the diagonal for nothing.
  if (corner.x % 16 || corner.y % 16) return;
  float16 sums[16];
  for (int k = 0; k < 16; ++k) sums[k] = 0.0f;
  for (int first = 0, end; first < n_rows; first = end) {
    end = n_rows - first > ROWS ? first + ROWS : n_rows;
    for (int part = 0; part < 16; part += SUMS) {
      float16 s[SUMS];
#pragma unroll
      for (int k = 0; k < SUMS; ++k) s[k] = sums[part + k];
      for (int row = first; row < end; ++row) {
        global const float* left = J + row * n_columns + corner.x + part;
        const float16 right = vload16(0, J + row * n_columns + corner.y);
#pragma unroll
        for (int k = 0; k < SUMS; ++k) s[k] += left[k] * right;
      }
#pragma unroll
      for (int k = 0; k < SUMS; ++k) sums[part + k] = s[k];
    }
  }
  global float* out = gram + 64 * block;
  // The tile below the first one, which exists right of the diagonal only, and the one beside it.
  const int below = block + (n_columns - corner.x) / 8 - 1;
  global float* out_below = gram + 64 * below;
  for (int k = 0; k < 8; ++k) {
    vstore8(sums[k].lo, k, out);
    vstore8(sums[k].hi, 8 + k, out);
    if (corner.y > corner.x) vstore8(sums[8 + k].lo, k, out_below);
    vstore8(sums[8 + k].hi, 8 + k, out_below);
  }
}

#endif
