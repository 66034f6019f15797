// The steps of conjugate gradients on one slice of rows (shared/lanes.h comes first): one row on a GPU. Vectors are of
// 3 planes, `stride` apart.
#ifndef LC_SURFACE_PCG_ROWS_H
#define LC_SURFACE_PCG_ROWS_H
#include "surface/direction.h"
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

// q = A p; returns p . q. blocks: 6 planes; edges: see regularizer_system.cl.
static inline REAL apply_row(int row, int stride, float w_smooth, global const int* slice_offsets,
                             global const int* neighbors, global const float* edge_weights, global const float* edges,
                             global const float* blocks, global const float* p, global float* q) {
  const Vec3 own = vec3(LOAD(p, row), LOAD(p, row + stride), LOAD(p, row + 2 * stride));
  Vec3 moved = times_block(load_block(blocks, row, stride), own);
  int begin = slice_offsets[row / SLICE];
  int end = slice_offsets[row / SLICE + 1];
  for (int base = begin; base < end; base += SLICE) {
    int at = base + row % SLICE;
    int e = 3 * base + row % SLICE;
    REAL k = w_smooth * LOAD(edge_weights, at);
    const Vec3 edge = vec3(LOAD(edges, e), LOAD(edges, e + SLICE), LOAD(edges, e + 2 * SLICE));
    moved = without_link(moved, k, edge, gather_direction(p, neighbors + at, stride));
  }
  STORE(moved.x, q, row);
  STORE(moved.y, q, row + stride);
  STORE(moved.z, q, row + 2 * stride);
  REAL product = own.x * moved.x + own.y * moved.y + own.z * moved.z;
  return product;
}

// step += alpha p, r -= alpha q, z = M^-1 r; returns r . z. inverse: 6 planes.
static inline REAL advance_row(int row, int stride, float alpha, global const float* inverse, global const float* p,
                               global const float* q, global float* step, global float* r, global float* z) {
  REAL rv[3];
  LC_UNROLL
  for (int a = 0; a < 3; ++a) {
    int at = row + a * stride;
    REAL moved = LOAD(step, at) + alpha * LOAD(p, at);
    STORE(moved, step, at);
    rv[a] = LOAD(r, at) - alpha * LOAD(q, at);
    STORE(rv[a], r, at);
  }
  const Vec3 made = times_block(load_block(inverse, row, stride), vec3(rv[0], rv[1], rv[2]));
  STORE(made.x, z, row);
  STORE(made.y, z, row + stride);
  STORE(made.z, z, row + 2 * stride);
  REAL product = rv[0] * made.x + rv[1] * made.y + rv[2] * made.z;
  return product;
}

// p = z + beta p
static inline void turn_row(int row, int stride, float beta, global const float* z, global float* p) {
  REAL turned[3];
  LC_UNROLL
  for (int a = 0; a < 3; ++a) {
    int at = row + a * stride;
    turned[a] = LOAD(z, at) + beta * LOAD(p, at);
  }
  store_direction(vec3(turned[0], turned[1], turned[2]), p, row, stride);
}

#endif
