// Projected triangles over the pixel grid. CPU bodies set up several triangles at once and look at eight neighbouring
// pixels of one, GPU bodies at one of each; the formulas are the same but
// for how they leave out what is not a number. Contraction is explicit (fma), so that two
// kernels and the two triangles of an edge get the same bits: edges are evaluated from their lower vertex index and
// leave no gap.
#ifndef LC_RASTER_TRIANGLE_H
#define LC_RASTER_TRIANGLE_H
#pragma OPENCL FP_CONTRACT OFF
#include "shared/lanes.h"
#include "shared/plain_math.h"

#if LC_CPU
typedef float8 edge_t;
#else
typedef float edge_t;
#endif

// Of one triangle (float) or of several (REAL). Edge k lies opposite corner k, positive inside; depths in mm.
#define LC_RASTER_EDGES(T) T ax[3], ay[3], dx[3], dy[3], inv_z[3], near_z, far_z
#define LC_RASTER_EDGE_VALUES 17

typedef struct {
  LC_RASTER_EDGES(float);
} RasterTriangle;

typedef struct {
  LC_RASTER_EDGES(REAL);
  LaneInt x0, x1, y0, y1;  // pixels of the image it may cover, inclusive
  LaneInt covers;          // 0: none
  LaneInt facing;          // 1 towards the camera, -1 away, 0 edge-on or not projected
} RasterTriangles;

// fmin, fmax, ceil and floor of numbers below 2^31, as one or two instructions each: PoCL 3.1's look for NaN and
// branch.
static inline REAL lower_of(REAL a, REAL b) {
  return a < b ? a : b;
}

static inline REAL higher_of(REAL a, REAL b) {
  return a > b ? a : b;
}

static inline LaneInt int_above(REAL a) {
  const LaneInt towards_zero = LANE_INT(a);
  return towards_zero + (LANE_REAL(towards_zero) < a ? (LaneInt)1 : (LaneInt)0);
}

static inline LaneInt int_below(REAL a) {
  const LaneInt towards_zero = LANE_INT(a);
  return towards_zero - (LANE_REAL(towards_zero) > a ? (LaneInt)1 : (LaneInt)0);
}

// Edge k, from (ua, va) to (ub, vb); forward: the first corner has the lower index.
static inline void set_edge(RasterTriangles* tri, int k, REAL side, LaneInt forward, REAL ua, REAL va, REAL ub,
                            REAL vb) {
  tri->ax[k] = forward ? ua : ub;
  tri->ay[k] = forward ? va : vb;
  tri->dx[k] = side * (ub - ua);
  tri->dy[k] = side * (vb - va);
}

// projected: [4*n_vertices] u, v (px), 1/z (1/mm, 0 = not projected), z (mm).
// cull: leave out triangles that face away.
static inline RasterTriangles raster_triangles(LaneInt t, int width, int height, int cull,
                                               global const float* restrict projected,
                                               global const int* restrict triangles) {
  RasterTriangles tri;
  const IntVec3 corners = gather_int_vec3(triangles, t);
  const LaneInt index[3] = {corners.x, corners.y, corners.z};
  REAL u[3], v[3];
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    const Vec4 corner = gather_vec4(projected, 4 * index[k]);
    u[k] = corner.x;
    v[k] = corner.y;
    tri.inv_z[k] = corner.z;
  }
  const REAL area = fma(u[1] - u[0], v[2] - v[0], -((v[1] - v[0]) * (u[2] - u[0])));
  const REAL low_inv_z = lower_of(tri.inv_z[0], lower_of(tri.inv_z[1], tri.inv_z[2]));
  const REAL high_inv_z = higher_of(tri.inv_z[0], higher_of(tri.inv_z[1], tri.inv_z[2]));
  // Faces that look at the camera are counter-clockwise, which is negative in an image whose y points down.
  const LaneInt projects = low_inv_z > 0.0f, towards = area<0.0f, away = area> 0.0f;
  const LaneInt one = 1, none = 0;
  tri.facing = projects ? (towards ? one : away ? -one : none) : none;
  const REAL right = (float)(width - 1), bottom = (float)(height - 1), zero = 0.0f;
  tri.x0 = int_above(higher_of(lower_of(u[0], lower_of(u[1], u[2])), zero));
  tri.x1 = int_below(lower_of(higher_of(u[0], higher_of(u[1], u[2])), right));
  tri.y0 = int_above(higher_of(lower_of(v[0], lower_of(v[1], v[2])), zero));
  tri.y1 = int_below(lower_of(higher_of(v[0], higher_of(v[1], v[2])), bottom));
  const LaneInt drawn = cull ? tri.facing == 1 : tri.facing != 0;
  tri.covers = drawn && tri.x0 <= tri.x1 && tri.y0 <= tri.y1;
  tri.near_z = 1.0f / high_inv_z;
  tri.far_z = 1.0f / low_inv_z;
  const REAL side = away ? (REAL)1.0f : (REAL)-1.0f;
  set_edge(&tri, 0, side, index[1] < index[2], u[1], v[1], u[2], v[2]);
  set_edge(&tri, 1, side, index[2] < index[0], u[2], v[2], u[0], v[0]);
  set_edge(&tri, 2, side, index[0] < index[1], u[0], v[0], u[1], v[1]);
  return tri;
}

// The only one, or that of lane k.
static inline RasterTriangle one_triangle(const RasterTriangles* tri, int k) {
  RasterTriangle one;
  const float* from = (const float*)tri + k;
  float* to = (float*)&one;
  const int lanes = sizeof(REAL) / sizeof(float);
#pragma unroll
  for (int i = 0; i < LC_RASTER_EDGE_VALUES; ++i) to[i] = from[lanes * i];
  return one;
}

// What row py adds to edge k.
static inline edge_t edge_row(const RasterTriangle* tri, int k, edge_t py) {
  return (edge_t)(tri->dx[k]) * (py - tri->ay[k]);
}

// Depth (mm) of the triangle at pixel px of a row, perspective-correct; outside INFINITY, or not a number. row0..row2:
// what the row adds to the edges.
static inline edge_t row_depth(const RasterTriangle* tri, edge_t px, edge_t row0, edge_t row1, edge_t row2) {
  const edge_t e0 = fma((edge_t)(-tri->dy[0]), px - tri->ax[0], row0);
  const edge_t e1 = fma((edge_t)(-tri->dy[1]), px - tri->ax[1], row1);
  const edge_t e2 = fma((edge_t)(-tri->dy[2]), px - tri->ax[2], row2);
  const edge_t sum = e0 + e1 + e2;
  const edge_t weighted = fma(e0, (edge_t)tri->inv_z[0], fma(e1, (edge_t)tri->inv_z[1], e2 * (edge_t)tri->inv_z[2]));
  const edge_t near_z = tri->near_z, far_z = tri->far_z;
  const edge_t quotient = sum / weighted;  // a number inside
#if LC_CPU
  // Where all edges are 0 the quotient is not a number, which passes both of these, and is not less than any depth.
  const edge_t not_nearer = near_z > quotient ? near_z : quotient;
  const edge_t z = far_z < not_nearer ? far_z : not_nearer;
  return select((edge_t)INFINITY, z, LC_LESSER(e0, LC_LESSER(e1, e2)) >= 0.0f);
#else
  const edge_t not_nearer = quotient > near_z ? quotient : near_z;
  const edge_t z = not_nearer < far_z ? not_nearer : far_z;
  return select((edge_t)INFINITY, z, (e0 >= 0.0f) & (e1 >= 0.0f) & (e2 >= 0.0f) & (sum > 0.0f));
#endif
}

// The same at pixel (px, py).
static inline edge_t raster_depth(const RasterTriangle* tri, edge_t px, edge_t py) {
  return row_depth(tri, px, edge_row(tri, 0, py), edge_row(tri, 1, py), edge_row(tri, 2, py));
}

#endif
