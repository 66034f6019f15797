// Depth (above) and triangle of a pixel in one word, on GPUs with atomics of 64 bits: the least word is the nearest
// triangle's, at equal depth the lower one's, so that one pass finds what draw_nearest() and draw_ids() of depth.cl
// find.
#ifndef LC_RASTER_DEPTH_AND_ID_H
#define LC_RASTER_DEPTH_AND_ID_H
#include "raster/layout.h"
#include "raster/triangle.h"

#pragma OPENCL EXTENSION cl_khr_int64_extended_atomics : enable

// Of a pixel where there is none.
#define LC_NOT_DRAWN (((ulong)as_uint(INFINITY) << 32) | 0xffffffffu)

// Clears such words, LC_RASTER_CLEAR of them.
static inline void clear_both(int i, int n_pixels, global ulong* restrict both) {
  const int first = LC_RASTER_CLEAR * i, end = min(first + LC_RASTER_CLEAR, n_pixels);
  for (int p = first; p + 1 < end; p += 2) *(global ulong2*)(both + p) = (ulong2)(LC_NOT_DRAWN);
  if ((end - first) % 2) both[end - 1] = LC_NOT_DRAWN;
}

// What draw_nearest and draw_ids find, in one pass.
static inline void draw_both(int item, int width, int height, int cull, global const float* restrict projected,
                             global const int* restrict triangles, global ulong* restrict both) {
  const int t = item / LC_RASTER_SHARE;
  const RasterTriangles tri = raster_triangles(t, width, height, cull, projected, triangles);
  if (!tri.covers) return;
  const RasterTriangle edges = one_triangle(&tri, 0);
  for (int y = tri.y0 + item % LC_RASTER_SHARE; y <= tri.y1; y += LC_RASTER_SHARE) {
    for (int x = tri.x0; x <= tri.x1; ++x) {
      const float z = raster_depth(&edges, (float)x, (float)y);
      if (z < INFINITY) atom_min(both + y * width + x, ((ulong)as_uint(z) << 32) | (uint)t);
    }
  }
}

// Each in its buffer, of LC_RASTER_CLEAR pixels.
static inline void take_apart(int i, int n_pixels, global const ulong* restrict both, global float* restrict depth,
                              global int* restrict ids) {
  for (int p = LC_RASTER_CLEAR * i; p < min(LC_RASTER_CLEAR * (i + 1), n_pixels); ++p) {
    depth[p] = as_float((uint)(both[p] >> 32));
    ids[p] = (int)(uint)both[p];
  }
}

#endif
