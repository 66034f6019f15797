// Preconditioned conjugate gradients on (J^T J + damping) step = -J^T F, matrix-free over SELL-16 slices; one row is a
// vertex (3 unknowns), the preconditioner is the inverse 3x3 diagonal block. A CPU with one compute unit does all
// iterations in one work-item; one with several launches each of the kernels (GPUs: pcg_phases.cl). All scalars stay on
// the device:
//   scalars[0] = r.z, [1] = alpha, [2] = beta, [3] = 1 when anything was not finite since the solve began.
// Sums run in a fixed order, so results repeat bit for bit.
#include "shared/lanes.h"
//
#include "surface/direction.h"
#include "surface/pcg_rows.h"

#if LC_CPU
// One work-item; four accumulators hide the latency of the additions. n is a multiple of 16.
static float sum_plane(global const float* restrict values, int n) {
  float16 a = 0.0f, b = 0.0f, c = 0.0f, d = 0.0f;
  int i = 0;
  for (; i + 64 <= n; i += 64) {
    a += vload16(0, values + i);
    b += vload16(0, values + i + 16);
    c += vload16(0, values + i + 32);
    d += vload16(0, values + i + 48);
  }
  for (; i < n; i += 16) a += vload16(0, values + i);
  a = (a + b) + (c + d);
  float8 e = a.lo + a.hi;
  float4 f = e.lo + e.hi;
  return (f.x + f.y) + (f.z + f.w);
}
#define SUM_PLANE(values, n) sum_plane(values, n)
#else
// One work-group of at most 256; the sum is valid in every work-item.
static float sum_plane(global const float* restrict values, int n, local float* scratch) {
  int id = get_local_id(0);
  int size = get_local_size(0);
  float sum = 0.0f;
  for (int i = id; i < n; i += size) sum += values[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  scratch[id] = sum;
  for (int half_size = 128; half_size > 0; half_size >>= 1) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (id < half_size && id + half_size < size) scratch[id] += scratch[id + half_size];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return scratch[0];
}
#define SUM_PLANE(values, n) sum_plane(values, n, scratch)
#endif

// The sum kernels run as one work-group (of one work-item on a CPU) for each sum.

// totals [8]: sums of three planes and of the five of `regularizer`.
kernel void sum_energies(int n_rows, int stride, global const float* restrict photo,
                         global const float* restrict silhouette, global const float* restrict match,
                         global const float* restrict regularizer, global float* restrict totals) {
#if !LC_CPU
  local float scratch[256];
#endif
  const int k = get_group_id(0);
  global const float* plane = k == 0 ? photo : k == 1 ? silhouette : k == 2 ? match : regularizer + (k - 3) * stride;
  const float sum = SUM_PLANE(plane, n_rows);
  if (get_local_id(0) == 0) totals[k] = sum;
}

#if LC_CPU

// Of a slice of rows; vectors are of 3 planes, `stride` apart.

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

// r.z at the start. first = 1 clears the failure flag.
kernel void start_scalars(int n_rows, int first, global const float* restrict products,
                          global float* restrict scalars) {
  const float sum = sum_plane(products, n_rows);
  scalars[0] = sum;
  scalars[1] = 0.0f;
  scalars[2] = 0.0f;
  scalars[3] = (!first && scalars[3] != 0.0f) || !isfinite(sum) ? 1.0f : 0.0f;
}

// alpha = r.z / p.Ap
static inline void set_alpha(float sum, global float* scalars) {
  float alpha = sum > 0.0f ? scalars[0] / sum : 0.0f;
  if (!isfinite(sum) || !isfinite(alpha)) {
    alpha = 0.0f;
    scalars[3] = 1.0f;
  }
  scalars[1] = alpha;
}

// beta = new r.z / old r.z
static inline void set_beta(float sum, global float* scalars) {
  float beta = scalars[0] > 0.0f ? sum / scalars[0] : 0.0f;
  if (!isfinite(sum) || !isfinite(beta)) {
    beta = 0.0f;
    scalars[3] = 1.0f;
  }
  scalars[0] = sum;
  scalars[2] = beta;
}

kernel void alpha_scalar(int n_rows, global const float* restrict products, global float* restrict scalars) {
  set_alpha(sum_plane(products, n_rows), scalars);
}

kernel void beta_scalar(int n_rows, global const float* restrict products, global float* restrict scalars) {
  set_beta(sum_plane(products, n_rows), scalars);
}

// q = A p, products = p . q per row.
kernel void apply_system(int n_rows, int stride, float w_smooth, global const int* restrict slice_offsets,
                         global const int* restrict neighbors, global const float* restrict edge_weights,
                         global const float* restrict edges, global const float* restrict blocks,
                         global const float* restrict p, global float* restrict q, global float* restrict products) {
  const int row = FIRST_ROW;
  if (row >= n_rows) return;
  const REAL product = apply_row(row, stride, w_smooth, slice_offsets, neighbors, edge_weights, edges, blocks, p, q);
  STORE(product, products, row);
}

// step += alpha p, r -= alpha q, z = M^-1 r, products = r . z per row.
kernel void advance(int n_rows, int stride, global const float* restrict scalars, global const float* restrict inverse,
                    global const float* restrict p, global const float* restrict q, global float* restrict step,
                    global float* restrict r, global float* restrict z, global float* restrict products) {
  const int row = FIRST_ROW;
  if (row >= n_rows) return;
  const REAL product = advance_row(row, stride, scalars[1], inverse, p, q, step, r, z);
  STORE(product, products, row);
}

// p = z + beta p
kernel void turn_direction(int n_rows, int stride, global const float* restrict scalars, global const float* restrict z,
                           global float* restrict p) {
  if (FIRST_ROW < n_rows) turn_row(FIRST_ROW, stride, scalars[2], z, p);
}

// All of these, in their order, in one work-item.
kernel __attribute__((reqd_work_group_size(1, 1, 1))) void all_iterations(
    int iterations, int n_rows, int stride, float w_smooth, global const int* restrict slice_offsets,
    global const int* restrict neighbors, global const float* restrict edge_weights, global const float* restrict edges,
    global const float* restrict blocks, global const float* restrict inverse, global float* restrict p,
    global float* restrict q, global float* restrict step, global float* restrict r, global float* restrict z,
    global float* restrict products, global float* restrict scalars) {
  for (int k = 0; k < iterations; ++k) {
    if (k > 0) {
      set_beta(sum_plane(products, n_rows), scalars);
      for (int row = 0; row < n_rows; row += LANES) turn_row(row, stride, scalars[2], z, p);
    }
    for (int row = 0; row < n_rows; row += LANES) {
      const REAL product =
          apply_row(row, stride, w_smooth, slice_offsets, neighbors, edge_weights, edges, blocks, p, q);
      STORE(product, products, row);
    }
    set_alpha(sum_plane(products, n_rows), scalars);
    for (int row = 0; row < n_rows; row += LANES) {
      const REAL product = advance_row(row, stride, scalars[1], inverse, p, q, step, r, z);
      STORE(product, products, row);
    }
  }
}

#endif

// v += step, each vertex by at most max_move mm.
kernel void move_vertices(int n_rows, int stride, float max_move, global const float* restrict step,
                          global float* restrict v) {
  int row = FIRST_ROW;
  if (row >= n_rows) return;
  Vec3 d = vec3(LOAD(step, row), LOAD(step, row + stride), LOAD(step, row + 2 * stride));
  REAL length = norm3(d);
  REAL scale = length > max_move ? max_move / length : 1.0f;
  REAL x = LOAD(v, row) + scale * d.x;
  REAL y = LOAD(v, row + stride) + scale * d.y;
  REAL z = LOAD(v, row + 2 * stride) + scale * d.z;
  STORE(x, v, row);
  STORE(y, v, row + stride);
  STORE(z, v, row + 2 * stride);
}
