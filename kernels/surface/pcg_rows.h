// The steps of conjugate gradients on one slice of rows (shared/lanes.h comes first): one row on a GPU. Vectors are of
// 3 planes, `stride` apart.
#ifndef LC_SURFACE_PCG_ROWS_H
#define LC_SURFACE_PCG_ROWS_H
#include "surface/system.h"

// q = A p; returns p . q. blocks: 6 planes; edges: see regularizer_system.cl.
static inline REAL apply_row(int row, int stride, float w_smooth, global const int* slice_offsets,
                             global const int* neighbors, global const float* edge_weights, global const float* edges,
                             global const float* blocks, global const float* p, global float* q) {
  global const float* px = p;
  global const float* py = p + stride;
  global const float* pz = p + 2 * stride;
  REAL x = LOAD(px, row), y = LOAD(py, row), z = LOAD(pz, row);
  REAL xy = LOAD(blocks, row + stride), xz = LOAD(blocks, row + 2 * stride), yz = LOAD(blocks, row + 4 * stride);
  REAL qx = LOAD(blocks, row) * x + xy * y + xz * z;
  REAL qy = xy * x + LOAD(blocks, row + 3 * stride) * y + yz * z;
  REAL qz = xz * x + yz * y + LOAD(blocks, row + 5 * stride) * z;
  int begin = slice_offsets[row / SLICE];
  int end = slice_offsets[row / SLICE + 1];
  for (int base = begin; base < end; base += SLICE) {
    int at = base + row % SLICE;
    int e = 3 * base + row % SLICE;
    LaneInt j = LOAD(neighbors, at);
    REAL k = w_smooth * LOAD(edge_weights, at);
    REAL jx = gather(px, j), jy = gather(py, j), jz = gather(pz, j);
    REAL ex = LOAD(edges, e), ey = LOAD(edges, e + SLICE), ez = LOAD(edges, e + 2 * SLICE);
    REAL along = ex * jx + ey * jy + ez * jz;
    qx -= k * jx + ex * along;
    qy -= k * jy + ey * along;
    qz -= k * jz + ez * along;
  }
  STORE(qx, q, row);
  STORE(qy, q, row + stride);
  STORE(qz, q, row + 2 * stride);
  REAL product = x * qx + y * qy + z * qz;
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
  REAL xy = LOAD(inverse, row + stride), xz = LOAD(inverse, row + 2 * stride), yz = LOAD(inverse, row + 4 * stride);
  REAL zx = LOAD(inverse, row) * rv[0] + xy * rv[1] + xz * rv[2];
  REAL zy = xy * rv[0] + LOAD(inverse, row + 3 * stride) * rv[1] + yz * rv[2];
  REAL zz = xz * rv[0] + yz * rv[1] + LOAD(inverse, row + 5 * stride) * rv[2];
  STORE(zx, z, row);
  STORE(zy, z, row + stride);
  STORE(zz, z, row + 2 * stride);
  REAL product = rv[0] * zx + rv[1] * zy + rv[2] * zz;
  return product;
}

// p = z + beta p
static inline void turn_row(int row, int stride, float beta, global const float* z, global float* p) {
  LC_UNROLL
  for (int a = 0; a < 3; ++a) {
    int at = row + a * stride;
    REAL turned = LOAD(z, at) + beta * LOAD(p, at);
    STORE(turned, p, at);
  }
}

#endif
