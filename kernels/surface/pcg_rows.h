// What an iteration of conjugate gradients does with one slice of rows (shared/lanes.h comes first): one row on a GPU.
#ifndef LC_SURFACE_PCG_ROWS_H
#define LC_SURFACE_PCG_ROWS_H
#include "surface/system.h"

// Symmetric, of 6 planes.
typedef struct {
  REAL xx, xy, xz, yy, yz, zz;
} Block;

static inline Block load_block(global const float* planes, int row, int stride) {
  const Block block = {LOAD(planes, row),
                       LOAD(planes, row + stride),
                       LOAD(planes, row + 2 * stride),
                       LOAD(planes, row + 3 * stride),
                       LOAD(planes, row + 4 * stride),
                       LOAD(planes, row + 5 * stride)};
  return block;
}

static inline Vec3 times_block(Block a, Vec3 v) {
  const REAL x = a.xx * v.x + a.xy * v.y + a.xz * v.z;
  const REAL y = a.xy * v.x + a.yy * v.y + a.yz * v.z;
  const REAL z = a.xz * v.x + a.yz * v.y + a.zz * v.z;
  return vec3(x, y, z);
}

// q without what a link draws from p of the vertex at its other end. k: w_smooth times the link's weight; e: its edge,
// see regularizer_system.cl.
static inline Vec3 without_link(Vec3 q, REAL k, Vec3 e, Vec3 p) {
  const REAL along = e.x * p.x + e.y * p.y + e.z * p.z;
  q.x -= k * p.x + e.x * along;
  q.y -= k * p.y + e.y * along;
  q.z -= k * p.z + e.z * along;
  return q;
}

#endif
