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

// What draw_nearest and draw_ids find, in one pass. share: work-items of a triangle, every so many rows each.
static inline void draw_both(int item, int share, int width, int height, int cull,
                             global const float* restrict projected, global const int* restrict triangles,
                             global ulong* restrict both) {
  const int t = item / share;
  const RasterTriangles tri = raster_triangles(t, width, height, cull, projected, triangles);
  if (!tri.covers) return;
  const RasterTriangle edges = one_triangle(&tri, 0);
  for (int y = tri.y0 + item % share; y <= tri.y1; y += share) {
    for (int x = tri.x0; x <= tri.x1; ++x) {
      const float z = raster_depth(&edges, (float)x, (float)y);
      if (z < INFINITY) atom_min(both + y * width + x, ((ulong)as_uint(z) << 32) | (uint)t);
    }
  }
}

#endif
