// [J | F]^T [J | F] in 8x8 tiles of the upper triangle: J^T J and J^T F at once, rows summed in fixed order.
// Tile t = (tile row a, tile column b >= a), counted along the rows.
#include "pose/layout.h"

// The tile's place, as first column of its rows and of its columns.
static inline int2 tile_corner(int tile, int n_tiles_per_side) {
  int a = 0;
  while (tile >= n_tiles_per_side - a) {
    tile -= n_tiles_per_side - a;
    ++a;
  }
  return (int2)(8 * a, 8 * (a + tile));
}

#if LC_CPU

// A work-item has as many columns as a vector: a tile, or two beside each other. Eight sums are what the latency of a
// multiplication and addition takes.
#if LC_VECTOR == 16
typedef float16 gram_t;
#define LOAD_GRAM vload16
#else
typedef float8 gram_t;
#define LOAD_GRAM vload8
#endif
#define GRAM_TILES (LC_VECTOR / 8)

// One work-item per tile, of which every second makes two where vectors are that wide. J [n_rows*n_columns + 8];
// columns from n_filled on hold nothing. Out: gram [n_tiles][8][8]; tiles of such columns alone may be left as they
// are.
kernel void pose_gram(int n_tiles, int n_rows, int n_columns, int n_filled, global const float* restrict J,
                      global float* restrict gram) {
  const int tile = get_global_id(0);
  if (tile >= n_tiles) return;
  const int2 corner = tile_corner(tile, n_columns / 8);
  if (corner.y >= n_filled || (corner.y - corner.x) % (8 * GRAM_TILES)) return;
  gram_t sums[8];
#pragma unroll
  for (int k = 0; k < 8; ++k) sums[k] = 0.0f;
  for (int row = 0; row < n_rows; ++row) {
    global const float* left = J + row * n_columns + corner.x;
    const gram_t right = LOAD_GRAM(0, J + row * n_columns + corner.y);
#pragma unroll
    for (int k = 0; k < 8; ++k) sums[k] += left[k] * right;
  }
  global float* out = gram + 64 * tile;
#if LC_VECTOR == 16
  for (int k = 0; k < 8; ++k) {
    vstore8(sums[k].lo, k, out);
    if (corner.y + 8 < n_columns) vstore8(sums[k].hi, 8 + k, out);
  }
#else
  for (int k = 0; k < 8; ++k) vstore8(sums[k], k, out);
#endif
}

#endif
