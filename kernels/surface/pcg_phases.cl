// Conjugate gradients on GPUs, all iterations in one launch. An iteration has three phases, between which all
// work-groups wait for each other: p = z + beta p; q = A p; step, r and z. Sums run in a fixed order: over the rows of
// a work-item, over the work-items of a group as a tree, over the groups.
#if !LC_CPU
#include "shared/lanes.h"
//
#include "shared/all_arrived.h"
#include "surface/pcg_rows.h"

#define GROUP 256

// The group's part of a sum.
static void store_part(float value, global float* part, local float* scratch) {
  const int id = get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  scratch[id] = value;
  for (int half_size = GROUP / 2; half_size > 0; half_size >>= 1) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (id < half_size) scratch[id] += scratch[id + half_size];
  }
  if (id == 0) *part = scratch[0];
}

// In order; so many are asked for before one is waited for.
#define AT_ONCE 32
static float sum_parts(global const float* part) {
  float sum = 0.0f;
  const int n = get_num_groups(0);
  for (int first = 0; first < n; first += AT_ONCE) {
    float several[AT_ONCE];
#pragma unroll
    for (int k = 0; k < AT_ONCE; ++k) several[k] = part[min(first + k, n - 1)];
#pragma unroll
    for (int k = 0; k < AT_ONCE; ++k) sum += first + k < n ? several[k] : 0.0f;
  }
  return sum;
}

// a / b, and 0 where b is not positive or the result is nothing.
static float ratio(float a, float b, global float* failed) {
  const float value = b > 0.0f ? a / b : 0.0f;
  if (isfinite(a) && isfinite(b) && isfinite(value)) return value;
  if (get_local_id(0) == 0) *failed = 1.0f;
  return 0.0f;
}

// Phases first..end-1 of a solve, three an iteration. arrived, state: see all_arrived.h. clear: whether the first phase
// forgets failures. z, p, step, products: as regularizer_system.cl leaves them. parts: of r.z and p.q of each
// iteration, [2*n_iterations+1][n_groups]. scalars[3]: 1 when anything was not finite.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void pcg_phases(
    int first, int end, int arrived, int clear, int n_rows, int stride, float w_smooth,
    global const int* restrict slice_offsets, global const int* restrict neighbors,
    global const float* restrict edge_weights, global const float* restrict edges, global const float* restrict blocks,
    global const float* restrict inverse, global const float* restrict products, global float* p, global float* q,
    global float* step, global float* r, global float* z, global float* parts, global float* scalars,
    volatile global int* state) {
  local float scratch[GROUP];
  local int given_up;
  const int n_groups = get_num_groups(0), group = get_group_id(0);
  for (int phase = first; phase < end; ++phase) {
    if (phase > first) {
      arrived += n_groups;
      if (!all_arrived(state, arrived, &given_up)) return;
    }
    global float* rz = parts + phase / 3 * 2 * n_groups;
    global float* pq = rz + n_groups;
    float sum = 0.0f;
    if (phase == 0) {
      if (clear && get_global_id(0) == 0) scalars[3] = 0.0f;
      for (int row = get_global_id(0); row < n_rows; row += get_global_size(0)) sum += products[row];
      store_part(sum, rz + group, scratch);
    } else if (phase % 3 == 0) {
      const float beta = ratio(sum_parts(rz), sum_parts(rz - 2 * n_groups), scalars + 3);
      for (int row = get_global_id(0); row < n_rows; row += get_global_size(0)) turn_row(row, stride, beta, z, p);
    } else if (phase % 3 == 1) {
      for (int row = get_global_id(0); row < n_rows; row += get_global_size(0))
        sum += apply_row(row, stride, w_smooth, slice_offsets, neighbors, edge_weights, edges, blocks, p, q);
      store_part(sum, pq + group, scratch);
    } else {
      const float alpha = ratio(sum_parts(rz), sum_parts(pq), scalars + 3);
      for (int row = get_global_id(0); row < n_rows; row += get_global_size(0))
        sum += advance_row(row, stride, alpha, inverse, p, q, step, r, z);
      store_part(sum, pq + n_groups + group, scratch);
    }
  }
}

#endif
