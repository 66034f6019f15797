// One frame of hanging cloth by position based dynamics (Mueller et al. 2007) with many small steps (Macklin et al.
// 2019), Jacobi instead of Gauss-Seidel: all of it in one launch, by one work-item on a CPU, on a GPU by work-groups
// that wait for each other once a step and once a smoothing. Rows are particles in SELL-16 slices
// (src/surface/sell.h); vectors are 3 planes, `stride` apart.
#include "shared/lanes.h"
//
#include "cloth/layout.h"
#include "shared/all_arrived.h"

#if LC_CPU
#define EACH_ROW(row, n_rows) for (int row = 0; row < (n_rows); row += LANES)
#define EACH(i, n) for (int i = 0; i < (n); ++i)
#define TOGETHER()
#else
// Work-items of a row, which share its links; the first of them does all else.
#define PARTS LC_CLOTH_PARTS
#define PART ((int)get_local_id(0) % PARTS)
#define ROWS (LC_CLOTH_GROUP(LC_CPU) / PARTS)  // of a work-group at a time
#define EACH_ROW(row, n_rows) \
  for (int row = get_global_id(0) / PARTS; PART == 0 && row < (n_rows); row += get_global_size(0) / PARTS)
#define EACH(i, n) for (int i = get_global_id(0); i < (n); i += get_global_size(0))
#define TOGETHER()              \
  arrived += get_num_groups(0); \
  if (!all_arrived(1, state, arrived, &given_up)) return
#endif

// A cone with round ends: from, along, 1 / |along|^2, radius at `from`, what it changes by.
typedef struct {
  float x, y, z, along_x, along_y, along_z, inverse, radius, change;
} Limb;

static inline Vec3 load3(global const float* planes, int row, int stride) {
  return vec3(LOAD(planes, row), LOAD(planes, row + stride), LOAD(planes, row + 2 * stride));
}

static inline void store3(Vec3 value, global float* planes, int row, int stride) {
  STORE(value.x, planes, row);
  STORE(value.y, planes, row + stride);
  STORE(value.z, planes, row + 2 * stride);
}

// limb: two ends of the frame before, two of this one (3 each), two radii. t: how far in between.
static inline Limb limb_at(global const float* limb, float t) {
  float from[3], along[3], square = 0.0f;
  LC_UNROLL
  for (int a = 0; a < 3; ++a) {
    from[a] = limb[a] + t * (limb[a + 6] - limb[a]);
    along[a] = limb[a + 3] + t * (limb[a + 9] - limb[a + 3]) - from[a];
    square += along[a] * along[a];
  }
  const Limb made = {from[0],
                     from[1],
                     from[2],
                     along[0],
                     along[1],
                     along[2],
                     square > 0.0f ? 1.0f / square : 0.0f,
                     limb[12],
                     limb[13] - limb[12]};
  return made;
}

// p moved out of the limb, whose radius is at most `reach`.
static inline Vec3 outside(Vec3 p, Limb limb, REAL reach) {
  const Vec3 from = vec3(p.x - limb.x, p.y - limb.y, p.z - limb.z);
  REAL s = (from.x * limb.along_x + from.y * limb.along_y + from.z * limb.along_z) * limb.inverse;
  s = s < 0.0f ? 0.0f : s;
  s = s > 1.0f ? 1.0f : s;
  const Vec3 out = vec3(from.x - s * limb.along_x, from.y - s * limb.along_y, from.z - s * limb.along_z);
  REAL radius = limb.radius + s * limb.change;
  radius = radius < reach ? radius : reach;
  const REAL distance = norm3(out);
  REAL push = (radius - distance) / (distance + LC_CLOTH_TINY);
  push = push > 0.0f ? push : 0.0f;
  return add3(p, scale3(out, push));
}

// Springs, gravity, drag and velocities. t: how far from the frame before to this one.
static inline void ahead_row(int row, int stride, ClothStep step, float t, global const float* is_free,
                             global const float* before, global const float* target, global const float* x,
                             global float* v, global float* ahead) {
  const Vec3 was = load3(before, row, stride), moves = sub3(load3(target, row, stride), was);
  const Vec3 goal = add3(was, scale3(moves, t)), at = load3(x, row, stride), old = load3(v, row, stride);
  const Vec3 carried = scale3(moves, step.per_second);
  Vec3 velocity = add3(old, scale3(sub3(carried, old), step.damped));
  const Vec3 stretched = sub3(goal, at);
  const REAL reached = step.spring_reach / (norm3(stretched) + LC_CLOTH_TINY);
  const REAL spring = step.spring * (reached < 1.0f ? reached : 1.0f);
  velocity = add3(scale3(velocity, step.air), scale3(stretched, spring));
  velocity = add3(velocity, vec3(step.falls_x, step.falls_y, step.falls_z));
  Vec3 next = add3(at, scale3(velocity, step.seconds));
  const REAL free = LOAD(is_free, row);
  next = add3(goal, scale3(sub3(next, goal), free));
  store3(velocity, v, row, stride);
  store3(next, ahead, row, stride);
}

// `moved` by the links of a particle at p: those of entries begin, begin + by, ... of its slice.
static inline Vec3 linked(int row, int stride, Vec3 p, Vec3 moved, int begin, int end, int by,
                          global const int* neighbors, global const float* pulls, global const float* lengths,
                          global const float* ahead) {
  for (int base = begin; base < end; base += by) {
    const int at = base + row % SLICE;
    const LaneInt j = LOAD(neighbors, at);
    const Vec3 link =
        vec3(gather(ahead, j) - p.x, gather(ahead + stride, j) - p.y, gather(ahead + 2 * stride, j) - p.z);
    const REAL stretched = 1.0f - LOAD(lengths, at) / (norm3(link) + LC_CLOTH_TINY);
    moved = add3(moved, scale3(link, LOAD(pulls, at) * stretched));
  }
  return moved;
}

// `from` of a particle, nearer to that of the others on its links by `shares` of them.
static inline Vec3 smoothed(int row, int stride, global const int* slice_offsets, global const int* neighbors,
                            global const float* shares, global const float* from) {
  const Vec3 own = load3(from, row, stride);
  Vec3 nearer = own;
  for (int base = slice_offsets[row / SLICE]; base < slice_offsets[row / SLICE + 1]; base += SLICE) {
    const LaneInt j = LOAD(neighbors, base + row % SLICE);
    const Vec3 other = vec3(gather(from, j), gather(from + stride, j), gather(from + 2 * stride, j));
    nearer = add3(nearer, scale3(sub3(other, own), LOAD(shares, base + row % SLICE)));
  }
  return nearer;
}

// What the links moved, then limbs, and the velocity that comes of both.
static inline void settle_row(int row, int stride, ClothStep step, Vec3 moved, const Limb* limbs,
                              global const float* reach, global float* x, global float* v) {
  LC_UNROLL
  for (int k = 0; k < LC_CLOTH_LIMBS; ++k) moved = outside(moved, limbs[k], LOAD(reach, row + k * stride));
  store3(scale3(sub3(moved, load3(x, row, stride)), step.inverse_seconds), v, row, stride);
  store3(moved, x, row, stride);
}

// first: not 0 where there is no frame before. vertices [n_rows]: of each particle; is_free [n_rows]: 1, or 0 for what
// is fastened to the skinned surface. pulls, lengths, shares [n_entries]: of the links (src/cloth/cloth_graph.h). limbs
// [LC_CLOTH_LIMBS][LC_CLOTH_LIMB_SIZE]; reach: LC_CLOTH_LIMBS planes, no limb is thicker for a particle. State: before
// and target (the skinned places of two frames), x, v; ahead: two times, since groups that are a step ahead write it
// while others read; after the steps how far particles are from their targets, smoothed n_smoothings times (cloth that
// is pushed together buckles as finely as its mesh is). arrived, state: see all_arrived.h. Moves n_moved vertices of
// skinned, start and start_before [3n]: moved [n_moved], as far as four particles each, particles and weights
// [4*n_moved].
kernel __attribute__((reqd_work_group_size(LC_CLOTH_GROUP(LC_CPU), 1, 1))) void simulate_cloth(
    int first, int n_steps, int n_smoothings, int n_rows, int stride, int n_moved, int arrived, ClothStep step,
    global const int* restrict slice_offsets, global const int* restrict neighbors, global const float* restrict pulls,
    global const float* restrict lengths, global const float* restrict shares, global const int* restrict vertices,
    global const float* restrict is_free, global const float* restrict limbs, global const float* restrict reach,
    global const int* restrict moved, global const int* restrict particles, global const float* restrict weights,
    global float* before, global float* target, global float* x, global float* v, global float* ahead,
    global float* restrict skinned, global float* restrict start, global float* restrict start_before,
    volatile global int* state) {
#if LC_CPU
  (void)arrived, (void)state;
#else
  local int given_up;
  local float parts[3 * LC_CLOTH_GROUP(LC_CPU)];
#endif
  EACH_ROW(row, n_rows) {
    const Vec3 place = gather_vec3(skinned, LOAD(vertices, row));
    store3(first ? place : load3(target, row, stride), before, row, stride);
    store3(place, target, row, stride);
    if (first) {
      store3(place, x, row, stride);
      store3(vec3(0.0f, 0.0f, 0.0f), v, row, stride);
    }
  }
  for (int k = 1; k <= n_steps; ++k) {
    const float t = (float)k / (float)n_steps;
    Limb now[LC_CLOTH_LIMBS];
    LC_UNROLL
    for (int i = 0; i < LC_CLOTH_LIMBS; ++i) now[i] = limb_at(limbs + LC_CLOTH_LIMB_SIZE * i, t);
    global float* there = ahead + k % 2 * 3 * stride;
    EACH_ROW(row, n_rows) ahead_row(row, stride, step, t, is_free, before, target, x, v, there);
    TOGETHER();
#if LC_CPU
    EACH_ROW(row, n_rows) {
      const Vec3 p = load3(there, row, stride);
      const Vec3 moved = linked(row, stride, p, p, slice_offsets[row / SLICE], slice_offsets[row / SLICE + 1], SLICE,
                                neighbors, pulls, lengths, there);
      settle_row(row, stride, step, moved, now, reach, x, v);
    }
#else
    for (int first_row = get_group_id(0) * ROWS; first_row < n_rows; first_row += get_num_groups(0) * ROWS) {
      const int at = first_row + get_local_id(0) / PARTS, row = min(at, n_rows - 1);
      const int begin = slice_offsets[row / SLICE], end = slice_offsets[row / SLICE + 1];
      const Vec3 p = load3(there, row, stride);
      Vec3 moved = PART == 0 ? p : vec3(0.0f, 0.0f, 0.0f);
      moved = linked(row, stride, p, moved, begin + PART * SLICE, end, PARTS * SLICE, neighbors, pulls, lengths, there);
      vstore3((float3)(moved.x, moved.y, moved.z), get_local_id(0), parts);
      barrier(CLK_LOCAL_MEM_FENCE);
      for (int i = 1; PART == 0 && i < PARTS; ++i) {
        const float3 other = vload3(get_local_id(0) + i, parts);
        moved = add3(moved, vec3(other.x, other.y, other.z));
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (PART == 0 && at < n_rows) settle_row(row, stride, step, moved, now, reach, x, v);
    }
#endif
  }
  TOGETHER();
  EACH_ROW(row, n_rows) store3(sub3(load3(x, row, stride), load3(target, row, stride)), ahead, row, stride);
  for (int k = 1; k <= n_smoothings; ++k) {
    TOGETHER();
    global const float* from = ahead + (k - 1) % 2 * 3 * stride;
    EACH_ROW(row, n_rows)
    store3(smoothed(row, stride, slice_offsets, neighbors, shares, from), ahead + k % 2 * 3 * stride, row, stride);
  }
  TOGETHER();
  global const float* away = ahead + n_smoothings % 2 * 3 * stride;
  EACH(i, n_moved) {
    for (int a = 0; a < 3; ++a) {
      float by = 0.0f;
      for (int k = 4 * i; k < 4 * i + 4; ++k) {
        const int at = particles[k] + a * stride;
        by += weights[k] * away[at];
      }
      const int to = 3 * moved[i] + a;
      skinned[to] += by;
      start[to] += by;
      start_before[to] += by;
    }
  }
}
