// One projected triangle over the pixel grid. CPU bodies look at eight neighbouring pixels at once, GPU bodies at one;
// the formulas are the same. Contraction is explicit (fma), so that two kernels and the two triangles of an edge get
// the same bits: edges are evaluated from their lower vertex index and leave no gap.
#ifndef LC_RASTER_TRIANGLE_H
#define LC_RASTER_TRIANGLE_H
#pragma OPENCL FP_CONTRACT OFF

#if LC_CPU
typedef float8 pix_t;
#else
typedef float pix_t;
#endif

typedef struct {
  float ax[3], ay[3], dx[3], dy[3];  // edge k lies opposite corner k; positive inside
  float inv_z[3];
  float near_z, far_z;  // mm
  int x0, x1, y0, y1;   // pixels of the image it may cover, inclusive; empty when x0 > x1 or y0 > y1
} RasterTriangle;

// fmin, fmax, ceil and floor of numbers below 2^31, as one or two instructions each: PoCL 3.1's look for NaN and
// branch.
static inline float lower_of(float a, float b) {
  return a < b ? a : b;
}

static inline float higher_of(float a, float b) {
  return a > b ? a : b;
}

static inline int int_above(float a) {
  const int towards_zero = (int)a;
  return towards_zero + ((float)towards_zero < a);
}

static inline int int_below(float a) {
  const int towards_zero = (int)a;
  return towards_zero - ((float)towards_zero > a);
}

// Edge k, from (ua, va) to (ub, vb); forward: the first corner has the lower index.
static inline void set_edge(RasterTriangle* tri, int k, float side, int forward, float ua, float va, float ub,
                            float vb) {
  tri->ax[k] = forward ? ua : ub;
  tri->ay[k] = forward ? va : vb;
  tri->dx[k] = side * (ub - ua);
  tri->dy[k] = side * (vb - va);
}

// projected: [4*n_vertices] u, v (px), 1/z (1/mm, 0 = not projected), z (mm).
// cull: leave out triangles that face away.
static inline RasterTriangle raster_triangle(int t, int width, int height, int cull,
                                             global const float* restrict projected,
                                             global const int* restrict triangles) {
  RasterTriangle tri;
  int index[3];
  float u[3], v[3];
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    index[k] = triangles[3 * t + k];
    const float4 p = vload4(index[k], projected);
    u[k] = p.x;
    v[k] = p.y;
    tri.inv_z[k] = p.z;
  }
  const float area = fma(u[1] - u[0], v[2] - v[0], -((v[1] - v[0]) * (u[2] - u[0])));
  // Faces that look at the camera are counter-clockwise, which is negative in an image whose y points down.
  if (area == 0.0f || (cull && area > 0.0f)) {
    tri.x0 = tri.y0 = 0;
    tri.x1 = tri.y1 = -1;
    return tri;
  }
  const float low_inv_z = lower_of(tri.inv_z[0], lower_of(tri.inv_z[1], tri.inv_z[2]));
  const float high_inv_z = higher_of(tri.inv_z[0], higher_of(tri.inv_z[1], tri.inv_z[2]));
  tri.x0 = int_above(higher_of(lower_of(u[0], lower_of(u[1], u[2])), 0.0f));
  tri.x1 = int_below(lower_of(higher_of(u[0], higher_of(u[1], u[2])), (float)(width - 1)));
  tri.y0 = int_above(higher_of(lower_of(v[0], lower_of(v[1], v[2])), 0.0f));
  tri.y1 = int_below(lower_of(higher_of(v[0], higher_of(v[1], v[2])), (float)(height - 1)));
  if (!(low_inv_z > 0.0f)) tri.y1 = tri.y0 - 1;
  if (tri.y0 > tri.y1 || tri.x0 > tri.x1) return tri;
  tri.near_z = 1.0f / high_inv_z;
  tri.far_z = 1.0f / low_inv_z;
  const float side = area > 0.0f ? 1.0f : -1.0f;
  set_edge(&tri, 0, side, index[1] < index[2], u[1], v[1], u[2], v[2]);
  set_edge(&tri, 1, side, index[2] < index[0], u[2], v[2], u[0], v[0]);
  set_edge(&tri, 2, side, index[0] < index[1], u[0], v[0], u[1], v[1]);
  return tri;
}

// Depth (mm) of the triangle at pixel (px, py), perspective-correct; INFINITY outside.
static inline pix_t raster_depth(const RasterTriangle* tri, pix_t px, float py) {
  const pix_t e0 = fma((pix_t)(-tri->dy[0]), px - tri->ax[0], (pix_t)(tri->dx[0] * (py - tri->ay[0])));
  const pix_t e1 = fma((pix_t)(-tri->dy[1]), px - tri->ax[1], (pix_t)(tri->dx[1] * (py - tri->ay[1])));
  const pix_t e2 = fma((pix_t)(-tri->dy[2]), px - tri->ax[2], (pix_t)(tri->dx[2] * (py - tri->ay[2])));
  const pix_t sum = e0 + e1 + e2;
  const pix_t weighted = fma(e0, (pix_t)tri->inv_z[0], fma(e1, (pix_t)tri->inv_z[1], e2 * (pix_t)tri->inv_z[2]));
  const pix_t near_z = tri->near_z, far_z = tri->far_z;
  const pix_t quotient = sum / weighted;  // a number inside
  const pix_t not_nearer = quotient > near_z ? quotient : near_z;
  const pix_t z = not_nearer < far_z ? not_nearer : far_z;
  return select((pix_t)INFINITY, z, (e0 >= 0.0f) & (e1 >= 0.0f) & (e2 >= 0.0f) & (sum > 0.0f));
}

#endif
