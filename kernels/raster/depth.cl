// Depth buffer and triangle-id buffer of a mesh. Nearest triangle wins, at equal depth the lower id.
#include "raster/layout.h"
#include "raster/triangle.h"
#include "shared/camera.h"
#include "shared/wide.h"

#ifdef LC_DEVICE

// Vertices further outside than this (px) are not projected: their pixels could not be told apart.
#define LC_MAX_PIXEL 1e6f

// projected: [4*n] u, v, 1/z, z; 1/z = 0 for a vertex that is too near, behind or not finite. The lanes from vertex
// `first` < n on.
static inline void project_lanes(int first, int n, float4 camera,
                                 global const float* restrict positions,  // [3*n] mm, camera frame
                                 global float* restrict projected) {
  const Vec3 p = gather_vec3(positions, lane_rows(first, n));
  const Pinhole pinhole = {camera.x, camera.y, camera.z, camera.w};
  const Vec2 uv = project_point(p, pinhole).uv;
  const LaneInt projects =
      p.z > LC_MIN_DEPTH_MM && p.z < INFINITY && fabs(uv.x) < LC_MAX_PIXEL && fabs(uv.y) < LC_MAX_PIXEL;
  const REAL none = 0.0f;
  store_vec4(projects ? uv.x : none, projects ? uv.y : none, projects ? 1.0f / p.z : none, p.z, projected, first, n);
}

#if LC_CPU

// Over the vertices, LANES each.
kernel void project_vertices(int n, float4 camera, global const float* restrict positions,
                             global float* restrict projected) {
  if (FIRST_ROW < n) project_lanes(FIRST_ROW, n, camera, positions, projected);
}

// Sets words first..last and some of begin..end - 1 beside them, sixteen at a time that share a cache line.
static inline void clear_words(int first, int last, int begin, int end, int word, global int* restrict to) {
  if (end - begin >= 16) {
    for (int p = first & ~15; p <= last; p += 16) store_int16((int16)word, to + clamp(p, begin, end - 16));
  } else {
    for (int p = first; p <= last; ++p) to[p] = word;
  }
}

// Empties what was drawn of a strip of LC_STRIP_ROWS rows.
static inline void clear_strip(int with_ids, int strip, int width, int height, global float* restrict depth,
                               global int* restrict drawn, global int* restrict ids, global int* restrict ids_drawn) {
  const int begin = strip * LC_STRIP_ROWS * width, end = min((strip + 1) * LC_STRIP_ROWS, height) * width;
  const int first = ~drawn[2 * strip], last = drawn[2 * strip + 1];
  for (int row = begin; row < end; row += width)
    clear_words(row + first, row + last, begin, end, as_int(INFINITY), (global int*)depth);
  if (with_ids) {
    const int ids_first = ids_drawn[2 * strip], ids_last = ids_drawn[2 * strip + 1];
    for (int row = begin; row < end; row += width) clear_words(row + ids_first, row + ids_last, begin, end, -1, ids);
  }
  drawn[2 * strip] = width;
  drawn[2 * strip + 1] = -1;
}

// Columns x0..x1 of rows y0..y1 of triangle t, LC_RASTER_ROWS at most, in a picture at least eight wide.
static inline void draw_rows(int with_ids, const RasterTriangle* tri, int t, int x0, int x1, int y0, int y1, int width,
                             global float* restrict depth, global int* restrict ids) {
  const float8 lane = (float8)(0, 1, 2, 3, 4, 5, 6, 7);
  float row0[LC_RASTER_ROWS], row1[LC_RASTER_ROWS], row2[LC_RASTER_ROWS];
  for (int y = y0; y <= y1; y += 8) {
    const float8 py = (float)y + lane;
    vstore8(edge_row(tri, 0, py), 0, row0 + (y - y0));
    vstore8(edge_row(tri, 1, py), 0, row1 + (y - y0));
    vstore8(edge_row(tri, 2, py), 0, row2 + (y - y0));
  }
  for (int x = x0; x <= x1; x += 8) {
    // The last eight pixels of a row are looked at again rather than reading past it.
    const int from = min(x, width - 8);
    const float8 px = (float)from + lane;
    for (int y = y0; y <= y1; ++y) {
      const int at = y * width + from;
      const float8 z = row_depth(tri, px, row0[y - y0], row1[y - y0], row2[y - y0]);
      const float8 old = vload8(0, depth + at);
      const int8 closer = z < old;  // storing without looking is faster than a branch
      store8(select(old, z, closer), depth + at);
      if (with_ids) store_int8(select(vload8(0, ids + at), (int8)t, closer), ids + at);
    }
  }
}

// Rows y0..y1 of triangle t in a picture less than eight wide.
static inline void draw_narrow(int with_ids, const RasterTriangle* tri, int t, int y0, int y1, int width,
                               global float* restrict depth, global int* restrict ids) {
  for (int y = y0; y <= y1; ++y) {
    float z[8];
    vstore8(raster_depth(tri, (float8)(0, 1, 2, 3, 4, 5, 6, 7), (float8)(float)y), 0, z);
    for (int x = 0; x < width; ++x) {
      if (!(z[x] < depth[y * width + x])) continue;
      depth[y * width + x] = z[x];
      if (with_ids) ids[y * width + x] = t;
    }
  }
}

// One band of strips of LC_STRIP_ROWS rows, which the work-item alone writes; see the kernels.
static inline void draw_band(int with_ids, int n_triangles, int width, int height, int n_bands, int cull,
                             global const float* restrict projected, global const int* restrict triangles,
                             global float* restrict depth, global int* restrict drawn, global int* restrict facing,
                             global int* restrict ids, global int* restrict ids_drawn) {
  const int band = get_global_id(0);
  if (band >= n_bands) return;
  const int n_strips = (height + LC_STRIP_ROWS - 1) / LC_STRIP_ROWS;
  const int first_strip = n_strips * band / n_bands, end_strip = n_strips * (band + 1) / n_bands;
  const int first_row = first_strip * LC_STRIP_ROWS;
  const int last_row = min(end_strip * LC_STRIP_ROWS, height) - 1;
  // Below 0: the strip still holds the last picture, from column ~drawn on.
  for (int strip = first_strip; strip < end_strip; ++strip) drawn[2 * strip] = ~drawn[2 * strip];
  for (int first = 0; first < n_triangles; first += LANES) {
    const RasterTriangles several =
        raster_triangles(lane_rows(first, n_triangles), width, height, cull, projected, triangles);
    if (band == 0) store_lanes(several.facing, facing + first);
    const LaneInt here = first + LANE_IDS < n_triangles && several.y0 <= last_row && several.y1 >= first_row;
    int x0s[LANES], x1s[LANES], y0s[LANES], y1s[LANES];
    STORE_LANES(several.x0, x0s);
    STORE_LANES(several.x1, x1s);
    STORE_LANES(max(several.y0, first_row), y0s);
    STORE_LANES(min(several.y1, last_row), y1s);
    for (uint left = lane_bits(several.covers && here); left; left &= left - 1) {
      const int k = lowest_bit(left), t = first + k;
      const RasterTriangle tri = one_triangle(&several, k);
      const int x0 = x0s[k], x1 = x1s[k], y0 = y0s[k], y1 = y1s[k];
      for (int strip = y0 / LC_STRIP_ROWS; strip <= y1 / LC_STRIP_ROWS; ++strip) {
        if (drawn[2 * strip] < 0) clear_strip(with_ids, strip, width, height, depth, drawn, ids, ids_drawn);
        drawn[2 * strip] = min(drawn[2 * strip], x0);
        drawn[2 * strip + 1] = max(drawn[2 * strip + 1], x1);
      }
      if (width >= 8) {
        for (int y = y0; y <= y1; y += LC_RASTER_ROWS)
          draw_rows(with_ids, &tri, t, x0, x1, y, min(y1, y + LC_RASTER_ROWS - 1), width, depth, ids);
      } else {
        draw_narrow(with_ids, &tri, t, y0, y1, width, depth, ids);
      }
    }
  }
  for (int strip = first_strip; strip < end_strip; ++strip)
    if (drawn[2 * strip] < 0) clear_strip(with_ids, strip, width, height, depth, drawn, ids, ids_drawn);
  if (!with_ids) return;
  for (int i = 2 * first_strip; i < 2 * end_strip; ++i) ids_drawn[i] = drawn[i];
}

// Over the bands. depth: [w*h] mm, INFINITY = empty; ids: [w*h], -1 = empty. drawn: [2*n_strips] first and last column
// whose depth is not empty before and, at the end, after it; ids_drawn: likewise of ids.
// facing: [n_triangles, rounded up to 16] 1 towards the camera, -1 away, 0 edge-on or not projected.
kernel void raster_bands(int n_triangles, int width, int height, int n_bands, int cull,
                         global const float* restrict projected, global const int* restrict triangles,
                         global float* restrict depth, global int* restrict drawn, global int* restrict facing,
                         global int* restrict ids, global int* restrict ids_drawn) {
  draw_band(1, n_triangles, width, height, n_bands, cull, projected, triangles, depth, drawn, facing, ids, ids_drawn);
}

// The same without the ids.
kernel void raster_depths(int n_triangles, int width, int height, int n_bands, int cull,
                          global const float* restrict projected, global const int* restrict triangles,
                          global float* restrict depth, global int* restrict drawn, global int* restrict facing) {
  draw_band(0, n_triangles, width, height, n_bands, cull, projected, triangles, depth, drawn, facing, 0, 0);
}

#else

// Clears LC_RASTER_CLEAR pixels, the i-th so many. Positive floats order like their bits, so a minimum over uint is a
// minimum over depth.
static inline void clear_pixels(int i, int n_pixels, global uint* restrict depth, global uint* restrict ids) {
  const int first = LC_RASTER_CLEAR * i, end = min(first + LC_RASTER_CLEAR, n_pixels);
  if (end - first == LC_RASTER_CLEAR) {  // one store each: vstore4 would be four
    *(global uint4*)(depth + first) = (uint4)(as_uint(INFINITY));
    *(global uint4*)(ids + first) = (uint4)(0xffffffffu);
    return;
  }
  for (int p = first; p < end; ++p) {
    depth[p] = as_uint(INFINITY);
    ids[p] = 0xffffffffu;
  }
}

// Projects the vertices and clears the picture, over whichever are more.
kernel void raster_begin(int n_vertices, int n_pixels, float4 camera, global const float* restrict positions,
                         global float* restrict projected, global uint* restrict depth, global uint* restrict ids) {
  const int i = get_global_id(0);
  if (i < n_vertices) project_lanes(i, n_vertices, camera, positions, projected);
  clear_pixels(i, n_pixels, depth, ids);
}

// LC_RASTER_SHARE work-items per triangle, every so many rows each: item < n_triangles * LC_RASTER_SHARE.
static inline void draw_nearest(int item, int width, int height, int cull, global const float* restrict projected,
                                global const int* restrict triangles, global uint* restrict depth) {
  const int t = item / LC_RASTER_SHARE;
  const RasterTriangles tri = raster_triangles(t, width, height, cull, projected, triangles);
  if (!tri.covers) return;
  const RasterTriangle edges = one_triangle(&tri, 0);
  for (int y = tri.y0 + item % LC_RASTER_SHARE; y <= tri.y1; y += LC_RASTER_SHARE) {
    for (int x = tri.x0; x <= tri.x1; ++x) {
      const float z = raster_depth(&edges, (float)x, (float)y);
      if (z < INFINITY) atomic_min(depth + y * width + x, as_uint(z));
    }
  }
}

kernel void raster_nearest(int n_triangles, int width, int height, int cull, global const float* restrict projected,
                           global const int* restrict triangles, global uint* restrict depth) {
  const int item = get_global_id(0);
  if (item / LC_RASTER_SHARE < n_triangles) draw_nearest(item, width, height, cull, projected, triangles, depth);
}

// Pixels of a row that a work-item compares at once.
#define AT_ONCE 4

// Second pass, item by item too: the lowest triangle that has the winning depth. -1 (all bits set) stays where there is
// none.
static inline void draw_ids(int item, int width, int height, int cull, global const float* restrict projected,
                            global const int* restrict triangles, global const uint* restrict depth,
                            global uint* restrict ids) {
  const int t = item / LC_RASTER_SHARE;
  const RasterTriangles tri = raster_triangles(t, width, height, cull, projected, triangles);
  if (!tri.covers) return;
  const RasterTriangle edges = one_triangle(&tri, 0);
  for (int y = tri.y0 + item % LC_RASTER_SHARE; y <= tri.y1; y += LC_RASTER_SHARE) {
    for (int first = tri.x0; first <= tri.x1; first += AT_ONCE) {
      uint nearest[AT_ONCE];  // loaded all at once: none waits for another
#pragma unroll
      for (int k = 0; k < AT_ONCE; ++k) nearest[k] = depth[y * width + min(first + k, tri.x1)];
#pragma unroll
      for (int k = 0; k < AT_ONCE; ++k) {
        const float z = raster_depth(&edges, (float)(first + k), (float)y);
        if (first + k <= tri.x1 && z < INFINITY && as_uint(z) == nearest[k])
          atomic_min(ids + y * width + first + k, (uint)t);
      }
    }
  }
}

kernel void raster_ids(int n_triangles, int width, int height, int cull, global const float* restrict projected,
                       global const int* restrict triangles, global const uint* restrict depth,
                       global uint* restrict ids) {
  const int item = get_global_id(0);
  if (item / LC_RASTER_SHARE < n_triangles) draw_ids(item, width, height, cull, projected, triangles, depth, ids);
}

#endif

// overlap: [2*h] per row the pixels in both the mesh and the mask ([w*h], more than 127 = set) and those in either.
#if LC_CPU

// One work-item per row.
kernel void row_overlaps(int width, int height, global const float* restrict depth, global const uchar* restrict mask,
                         global int* restrict overlap) {
  const int y = get_global_id(0);
  if (y >= height) return;
  int16 both = 0, either = 0;  // -1 per pixel
  int x = 0;
  for (; x + 16 <= width; x += 16) {
    const int16 drawn = vload16(0, depth + y * width + x) < INFINITY;
    const int16 set = convert_int16(vload16(0, mask + y * width + x)) > 127;
    both += drawn & set;
    either += drawn | set;
  }
  int8 sum8 = both.lo + both.hi;
  int4 sum4 = sum8.lo + sum8.hi;
  int n_both = -(sum4.x + sum4.y + sum4.z + sum4.w);
  sum8 = either.lo + either.hi;
  sum4 = sum8.lo + sum8.hi;
  int n_either = -(sum4.x + sum4.y + sum4.z + sum4.w);
  for (; x < width; ++x) {
    const int drawn = depth[y * width + x] < INFINITY;
    const int set = mask[y * width + x] > 127;
    n_both += drawn & set;
    n_either += drawn | set;
  }
  overlap[2 * y] = n_both;
  overlap[2 * y + 1] = n_either;
}

#else

// One work-group per row.
kernel void row_overlaps(int width, int height, global const float* restrict depth, global const uchar* restrict mask,
                         global int* restrict overlap) {
  local int sums[2];
  const int y = get_group_id(0);
  if (y >= height) return;
  for (int k = get_local_id(0); k < 2; k += get_local_size(0)) sums[k] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  int n_both = 0, n_either = 0;
  for (int x = get_local_id(0); x < width; x += get_local_size(0)) {
    const int drawn = depth[y * width + x] < INFINITY;
    const int set = mask[y * width + x] > 127;
    n_both += drawn & set;
    n_either += drawn | set;
  }
  atomic_add(sums, n_both);
  atomic_add(sums + 1, n_either);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = get_local_id(0); k < 2; k += get_local_size(0)) overlap[2 * y + k] = sums[k];
}

#endif

#endif
