// Conjugate gradients on GPUs, all iterations in one launch. An iteration has two phases, between which all work-groups
// wait for each other: p = z + beta p, of a row and once more of its neighbours, and q = A p; then step, r and z. Sums
// run in a fixed order: over the rows of a work-item, over the work-items of a group as a tree, over the groups.
#if !LC_CPU
#include "shared/lanes.h"
//
#include "shared/all_arrived.h"
#include "surface/layout.h"
#include "surface/pcg_rows.h"

#define GROUP LC_PCG_GROUP

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

// Sums of two rows of parts, in order. Each is loaded once: a whole group that asks for all of them waits far longer.
// scratch: [2*GROUP], at most GROUP groups.
static float2 sums_of_parts(global const float* one, global const float* other, local float* scratch) {
  const int id = get_local_id(0), n = get_num_groups(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (id < n) {
    scratch[id] = one[id];
    scratch[GROUP + id] = other[id];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  float2 sum = 0.0f;
  for (int k = 0; k < n; ++k) sum += (float2)(scratch[k], scratch[GROUP + k]);
  return sum;
}

// of.x / of.y, and 0 where that is not positive or the result is nothing.
static float ratio(float2 of, global float* failed) {
  const float a = of.x, b = of.y;
  const float value = b > 0.0f ? a / b : 0.0f;
  if (isfinite(a) && isfinite(b) && isfinite(value)) return value;
  if (get_local_id(0) == 0) *failed = 1.0f;
  return 0.0f;
}

typedef struct {
  Vec3 p, q, step, r, z;
} Row;

// What an iteration needs of a row that none changes; the first of its links, those that are not there without weight.
#define LINKS 8
typedef struct {
  Block block, inverse;
  int j[LINKS];
  float k[LINKS];
  Vec3 e[LINKS];
} Fixed;

static Vec3 load3(global const float* planes, int row, int stride) {
  return vec3(planes[row], planes[row + stride], planes[row + 2 * stride]);
}

static void store3(Vec3 value, global float* planes, int row, int stride) {
  planes[row] = value.x;
  planes[row + stride] = value.y;
  planes[row + 2 * stride] = value.z;
}

// z + beta p
static Vec3 turned(Vec3 z, float beta, Vec3 p) {
  return vec3(z.x + beta * p.x, z.y + beta * p.y, z.z + beta * p.z);
}

static float dot_of(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// LINKS links from entry `base` of the row's slice on.
static void load_links(Fixed* fixed, int row, int base, int end, float w_smooth, global const int* neighbors,
                       global const float* edge_weights, global const float* edges) {
#pragma unroll
  for (int i = 0; i < LINKS; ++i, base += SLICE) {
    const int at = base + row % SLICE, e = 3 * base + row % SLICE;
    const int there = base < end;
    fixed->j[i] = there ? neighbors[at] : row;
    fixed->k[i] = there ? w_smooth * edge_weights[at] : 0.0f;
    fixed->e[i] = vec3(there ? edges[e] : 0.0f, there ? edges[e + SLICE] : 0.0f, there ? edges[e + 2 * SLICE] : 0.0f);
  }
}

// q without what these links draw.
static Vec3 without_links(Vec3 q, const Fixed* fixed, float beta, int stride, global const float* z,
                          global const float* p) {
  Vec3 there[LINKS];
#pragma unroll
  for (int i = 0; i < LINKS; ++i) there[i] = turned(load3(z, fixed->j[i], stride), beta, load3(p, fixed->j[i], stride));
#pragma unroll
  for (int i = 0; i < LINKS; ++i) q = without_link(q, fixed->k[i], fixed->e[i], there[i]);
  return q;
}

// Phases first..end-1 of a solve, two an iteration. arrived, state: see all_arrived.h. clear: whether the first phase
// forgets failures. z, step, products: as regularizer_system.cl leaves them. p: two times 3 planes, those of an
// iteration and of the one before in turns. parts: of r.z and p.q of each iteration, [2*n_iterations+1][n_groups].
// scalars[3]: 1 when anything was not finite. Where there is a work-item for each row it keeps all that is its own.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void pcg_phases(
    int first, int end, int arrived, int clear, int n_rows, int stride, float w_smooth,
    global const int* restrict slice_offsets, global const int* restrict neighbors,
    global const float* restrict edge_weights, global const float* restrict edges, global const float* restrict blocks,
    global const float* restrict inverse, global const float* restrict products, global float* p, global float* q,
    global float* step, global float* r, global float* z, global float* parts, global float* scalars,
    volatile global int* state) {
  local float scratch[2 * GROUP];
  local int given_up;
  const int n_groups = get_num_groups(0), group = get_group_id(0), keeps = (int)get_global_size(0) >= n_rows;
  Row own;
  Fixed fixed;
  for (int phase = first; phase < end; ++phase) {
    if (phase > first) {
      arrived += n_groups;
      if (!all_arrived(1, state, arrived, &given_up)) return;
    }
    const int k = phase / 2, turns = phase % 2 == 0;
    global float* rz = parts + 2 * k * n_groups;
    global float* pq = rz + n_groups;
    global float* p_now = p + k % 2 * 3 * stride;
    global const float* p_before = k > 0 ? p + (k + 1) % 2 * 3 * stride : z;
    if (phase == 0) {
      if (clear && get_global_id(0) == 0) scalars[3] = 0.0f;
      float sum = 0.0f;
      for (int row = get_global_id(0); row < n_rows; row += get_global_size(0)) sum += products[row];
      store_part(sum, rz + group, scratch);
    }
    float scale = 0.0f, sum = 0.0f;  // alpha or beta
    if (phase > 0) scale = ratio(sums_of_parts(rz, turns ? rz - 2 * n_groups : pq, scratch), scalars + 3);
    for (int row = get_global_id(0); row < n_rows; row += get_global_size(0)) {
      const int begin = slice_offsets[row / SLICE], behind = slice_offsets[row / SLICE + 1];
      if (!keeps || phase == first) {
        const Row loaded = {load3(turns ? p_before : p_now, row, stride), load3(q, row, stride),
                            load3(step, row, stride), load3(r, row, stride), load3(z, row, stride)};
        own = loaded;
        fixed.block = load_block(blocks, row, stride);
        fixed.inverse = load_block(inverse, row, stride);
        load_links(&fixed, row, begin, behind, w_smooth, neighbors, edge_weights, edges);
      }
      if (turns) {
        own.p = turned(own.z, scale, own.p);
        store3(own.p, p_now, row, stride);
        own.q = without_links(times_block(fixed.block, own.p), &fixed, scale, stride, z, p_before);
        for (int base = begin + LINKS * SLICE; base < behind; base += LINKS * SLICE) {
          Fixed more;
          load_links(&more, row, base, behind, w_smooth, neighbors, edge_weights, edges);
          own.q = without_links(own.q, &more, scale, stride, z, p_before);
        }
        sum += dot_of(own.p, own.q);
      } else {
        own.step = turned(own.step, scale, own.p);
        own.r = turned(own.r, -scale, own.q);
        own.z = times_block(fixed.inverse, own.r);
        store3(own.z, z, row, stride);
        sum += dot_of(own.r, own.z);
      }
      if (keeps && phase + 1 < end) continue;
      store3(own.q, q, row, stride);
      store3(own.step, step, row, stride);
      store3(own.r, r, row, stride);
    }
    store_part(sum, (turns ? pq : pq + n_groups) + group, scratch);
  }
}

#endif
