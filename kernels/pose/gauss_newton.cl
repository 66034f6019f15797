// Gauss-Newton steps on GPUs. A work-group makes LC_POSE_GROUP_ROWS rows of J at a time in local memory and their part
// of [J | F]^T [J | F]; the parts are added in order. All steps of a solve are one launch: groups wait for each other
// before the parts are added and before the step is solved for, which each does for itself, as it does with the
// kinematic chain. Where groups do not wait the host launches each step; without double precision
// (LC_POSE_TAKES_STEPS 0) it does the chain, too.
//
// Barriers are in no branch and the loop is left at two places only: PoCL compiles what follows a branch with a barrier
// once for every way there.
#if !LC_CPU
#if !defined(LC_POSE_TAKES_STEPS) && defined(cl_khr_fp64)
#define LC_POSE_TAKES_STEPS 1
#endif
#define LC_POSE_SPACE local
#include "shared/lanes.h"
//
#include "pose/chain.h"
#include "pose/contour_records.cl"
#include "pose/damped_step.h"
#include "pose/match_records.cl"
#include "pose/point_records.cl"
#include "pose/round_start.h"
#include "pose/shading_records.cl"
#include "shared/all_arrived.h"
//
#include "pose/fill_rows.cl"
#include "pose/gram.cl"

#define ROWS LC_POSE_GROUP_ROWS
#if LC_POSE_TAKES_STEPS
typedef double real64;
#else
typedef long real64;  // of arguments that are not used
#endif

// The part of the normal equations of ROWS rows of J, [n_tiles][8][8]: a quarter of a tile at a time. rows: n_columns
// / 4 each.
static void gram_of_rows(int n_columns, local const float4* rows, global float* part) {
  const int n_tiles = n_columns / 8 * (n_columns / 8 + 1) / 2;
  for (int i = get_local_id(0); i < n_tiles * 4; i += LC_POSE_GROUP) {
    const int2 corner = tile_corner(i / 4, n_columns / 8);
    const int y = i % 4 / 2 * 4, x = i % 2 * 4;
    local const float4* above = rows + (corner.x + y) / 4;
    local const float4* beside = rows + (corner.y + x) / 4;
    float4 sums[4] = {0.0f, 0.0f, 0.0f, 0.0f};
#pragma unroll 8
    for (int row = 0; row < ROWS; ++row) {
      const float4 left = above[row * (n_columns / 4)], right = beside[row * (n_columns / 4)];
      sums[0] += left.x * right;
      sums[1] += left.y * right;
      sums[2] += left.z * right;
      sums[3] += left.w * right;
    }
    for (int k = 0; k < 4; ++k) vstore4(sums[k], 0, part + i / 4 * 64 + (y + k) * 8 + x);
  }
}

// gram [n] of parts [n_parts][n], n a multiple of 32: so many entries a group at a time, in LC_POSE_GROUP / 32 sums
// each.
static void add_parts(int n, int n_parts, global const float* parts, global float* gram, local float* sums) {
  const int id = get_local_id(0);
  for (int first = 32 * get_group_id(0); first < n; first += 32 * get_num_groups(0)) {
    float sum = 0.0f;
#pragma unroll 8
    for (int p = id / 32; p < n_parts; p += LC_POSE_GROUP / 32) sum += parts[p * n + first + id % 32];
    sums[id] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (id < 32) {
      for (int k = 1; k < LC_POSE_GROUP / 32; ++k) sum += sums[32 * k + id];
      gram[first + id] = sum;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// Words that every work-item copies at most before the next ones wait for them.
#define COPIED 8

// All loads of a work-item are under way before the first one is waited for.
static void copy_words(int n, global const float* restrict from, local float* restrict to) {
  for (int first = get_local_id(0); first < n; first += COPIED * LC_POSE_GROUP) {
    float words[COPIED];
#pragma unroll
    for (int k = 0; k < COPIED; ++k) words[k] = from[min(first + k * LC_POSE_GROUP, n - 1)];
#pragma unroll
    for (int k = 0; k < COPIED; ++k)
      if (first + k * LC_POSE_GROUP < n) to[first + k * LC_POSE_GROUP] = words[k];
  }
}

// steps.most steps from the state in the inputs on (steps.continues: from that in results) and the residuals where they
// end; or, if that is negative, rows, residuals and parts there, by a group for each ROWS rows (without
// LC_POSE_TAKES_STEPS: at `from`). Rows: point rows, then contour, then matches (two each), then shaded vertices, each
// kind from a multiple of ROWS on. Other arguments: layout.h and the functions that are called. Out: results: layout.h;
// moved: how far a keypoint went, px, -1 after a failure; motions [8*n_bones]: dual quaternions where it ended; J
// [n_rows*n_columns]; kept: layout.h, of such a solve and for the next; parts [n_parts][n_tiles][8][8] and their sum
// gram. state: see all_arrived.h; next, chosen: of the launches that follow, set to 0.
// rows: ROWS * n_columns floats; near: LC_POSE_NEAR_SIZE; memory: LC_POSE_LOCAL.
kernel __attribute__((reqd_work_group_size(LC_POSE_GROUP, 1, 1))) void pose_gauss_newton(
    PoseLayout layout, float4 camera, PoseContour contour, float keypoint_huber_px, float match_huber_px,
    float shading_huber, float sqrt_anatomic, PoseInputs at, PoseStepsArg steps, global const float* restrict inputs,
    global const real64* restrict constants, global const int* restrict links, global const float* restrict moves,
    global const float* restrict limits, global const float* restrict rest, global const float* restrict rest_normals,
    global const float* restrict displacement, global const int* restrict bones, global const float* restrict weights,
    global const float* restrict distance, global const float* restrict from, global real64* kept,
    global float* restrict J, global float* parts, global float* gram, global float* results,
    volatile global int* state, global float* moved, global float* motions, volatile global int* next,
    volatile global int* chosen, local float4* rows, local float* near, local real64* memory) {
  const int id = get_local_id(0), group = get_group_id(0), n_groups = get_num_groups(0);
  const int n_columns = layout.n_columns, n_point = LC_POSE_POINT_ROWS + 2 * layout.n_dofs + layout.n_soles;
  global const int* counts = (global const int*)(inputs + at.counts);
  const int n_matches = counts[LC_POSE_COUNT_MATCHES], n_shaded = counts[LC_POSE_COUNT_SHADED];
  contour.n = counts[LC_POSE_COUNT_CONTOUR];
  contour.sqrt_weight = inputs[at.counts + LC_POSE_COUNT_CONTOUR_ROOT];
  const int n_of[4] = {n_point, contour.n, 2 * n_matches, n_shaded};
  int n_parts = 0, n_rows = 0;
  for (int kind = 0; kind < 4; ++kind) {
    n_parts += (n_of[kind] + ROWS - 1) / ROWS;
    n_rows += n_of[kind];
  }
  global float* residuals = results + LC_POSE_RESULT_RESIDUALS(layout);
  local float* step = near;
  local float* records = step + LC_POSE_STEP_SIZE(layout);
  local float* of_rows = records + ROWS * LC_POSE_RECORD;
  local float* targets = of_rows + ROWS;
  local float* ground = targets + LC_POSE_TARGET * LC_POSE_KEYPOINTS;
  for (int i = id; i < LC_POSE_TARGET * LC_POSE_KEYPOINTS; i += LC_POSE_GROUP) targets[i] = inputs[at.targets + i];
  for (int i = id; i < LC_POSE_GROUND_STANDS + layout.n_soles; i += LC_POSE_GROUP) ground[i] = inputs[at.ground + i];
  local float* moved_by = ground + LC_POSE_GROUND_STANDS + layout.n_soles;
  copy_words(layout.n_bones * n_columns, moves, moved_by);
#if LC_POSE_TAKES_STEPS
  (void)from;
  if (moved[0] < steps.least_moved_px) return;
  local int given_up, finite[2];
  local double* unknowns = memory;
  local double* chain_memory = unknowns + LC_POSE_STATE_SIZE(layout);
  const Chain chain = chain_in(layout, constants, links, chain_memory);
  int arrived = steps.arrived, together = 1, status = LC_POSE_SOLVED, taken = 0, has_chain = 0;
  global const double* first = (global const double*)(steps.continues ? results : inputs + at.start);
  for (int i = id; i < LC_POSE_STATE_SIZE(layout); i += LC_POSE_GROUP) unknowns[i] = first[i];
  global float* kept_step = (global float*)(kept + 3 * LC_POSE_KEYPOINTS);
  for (int i = id; steps.continues && i < 3 * LC_POSE_KEYPOINTS; i += LC_POSE_GROUP) chain.keypoints[i] = kept[i];
  copy_words(steps.continues ? LC_POSE_STEP_SIZE(layout) : 0, kept_step, step);
  barrier(CLK_LOCAL_MEM_FENCE);
  while (true) {
    const bool is_posed = taken == 0 && steps.continues;
    pose_chain(!is_posed, layout, unknowns, chain);
    has_chain |= !is_posed;
    const double moved_px = write_step(!is_posed, layout, camera, unknowns, chain, step);
    start_round(taken == 0, layout, steps, inputs + at.soles_before, chain, unknowns, step, targets, ground);
    const int is_last = taken >= steps.most || (taken > 0 && moved_px < steps.settled_px);
    const int counts_rows = !is_last || steps.most < 0, n_made = is_last && !steps.tells ? 0 : n_parts;
#else
  (void)constants, (void)kept, (void)gram, (void)state, (void)memory, (void)moved, (void)motions, (void)next,
      (void)chosen;
  for (int i = id; i < LC_POSE_STEP_SIZE(layout); i += LC_POSE_GROUP) step[i] = from[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  const int counts_rows = 1, n_made = n_parts;
  {
#endif
    for (int part = group; part < n_made; part += n_groups) {
      int kind = 0, before = 0, first = part * ROWS;  // of its kind; rows of the kinds before
      for (; first >= n_of[kind]; ++kind) {
        first -= (n_of[kind] + ROWS - 1) / ROWS * ROWS;
        before += n_of[kind];
      }
      const int left = min(ROWS, n_of[kind] - first);
      if (kind == 0) {
        const int row = first + id, limit = row - LC_POSE_POINT_ROWS;
        const Pinhole cam = {camera.x, camera.y, camera.z, camera.w};
        if (id < left && (limit >= 0 || row % LC_POSE_ROWS_PER_KEYPOINT == 0))
          point_records(limit >= 0 ? LC_POSE_KEYPOINTS + limit : row / LC_POSE_ROWS_PER_KEYPOINT, layout, cam,
                        keypoint_huber_px, first, step, targets, links + LC_POSE_LINKS_POINTS(layout), limits, ground,
                        sqrt_anatomic, records, of_rows);
      } else if (kind == 1) {
        if (id < left)
          contour_records(first + id, id, layout, camera, contour, step,
                          (global const int*)(inputs + at.contour_vertices), rest, rest_normals, displacement, bones,
                          weights, distance, records, of_rows, residuals + n_rows);
      } else if (kind == 2) {
        if (2 * id < left)
          match_records(first / 2 + id, id, layout, camera, n_matches, match_huber_px, step,
                        (global const int*)(inputs + at.match_vertices), inputs + at.match_targets, rest, bones,
                        weights, records, of_rows);
      } else if (id < left) {
        shading_records(first + id, id, layout, n_shaded, shading_huber, step,
                        (global const int*)(inputs + at.shaded_vertices), inputs + at.shaded_targets, rest_normals,
                        bones, weights, records, of_rows);
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (id < left) residuals[before + first + id] = of_rows[id];
      const int blocks = n_columns / FILL_COLUMNS;
      for (int i = id; counts_rows && i < ROWS * blocks; i += LC_POSE_GROUP) {
        const int row = i / blocks, column = i % blocks * FILL_COLUMNS;
        columns_t value = 0.0f;
        if (row < left) {
          value = kind == 0 ? point_columns(layout, row, column, step, moved_by, records, of_rows)
                            : skinned_columns(layout, row, kind == 2 ? 2 : 1, column, step, moved_by, records, of_rows);
          if (steps.write_rows) vstore8(value, 0, J + (before + first + row) * n_columns + column);
        }
        rows[i * 2] = value.lo;
        rows[i * 2 + 1] = value.hi;
      }
      barrier(CLK_LOCAL_MEM_FENCE);
      if (counts_rows) gram_of_rows(n_columns, rows, parts + part * LC_POSE_GRAM_SIZE(layout));
      barrier(CLK_LOCAL_MEM_FENCE);
    }
#if LC_POSE_TAKES_STEPS
    if (is_last) break;
    arrived += n_groups;
    together &= all_arrived(state, arrived, &given_up);
    add_parts(LC_POSE_GRAM_SIZE(layout), n_parts, parts, gram, (local float*)rows);
    arrived += n_groups;
    together &= all_arrived(state, arrived, &given_up);
    if (group == 0 && id == 0)
      results[LC_POSE_RESULT_ENERGY(layout) + taken] = gram_entry(layout, gram, layout.n_unknowns, layout.n_unknowns);
    status = damped_step(layout, steps, gram, chain_memory + LC_POSE_CHAIN_LOCAL(layout), finite, unknowns);
    ++taken;
    if (!together || status != LC_POSE_SOLVED) break;
  }
  global int* told = (global int*)results;
  if (!together && id == 0) told[LC_POSE_RESULT_GAVE_UP(layout)] = 1;
  if (group > 0) return;
  for (int i = id; i < LC_POSE_STATE_SIZE(layout); i += LC_POSE_GROUP) ((global double*)results)[i] = unknowns[i];
  if (id < LC_POSE_COUNTS) told[LC_POSE_RESULT_COUNTS(layout) + id] = counts[id];
  if (id < LC_POSE_KEYPOINTS) {
    results[LC_POSE_RESULT_ROOTS_3D(layout) + id] = targets[LC_POSE_TARGET * id + LC_POSE_TARGET_ROOT_3D];
    chain.moved_px[id] = way_px(layout, camera, id, chain, vload3(id, chain.start), vload3(id, chain.keypoints));
  }
  if (has_chain) {  // else this round ended before it moved, and those of the round before stay
    for (int i = id; i < LC_POSE_STEP_SIZE(layout); i += LC_POSE_GROUP) kept_step[i] = step[i];
    for (int i = id; i < 3 * LC_POSE_KEYPOINTS; i += LC_POSE_GROUP) kept[i] = chain.keypoints[i];
    const double3 root = vload3(0, unknowns + LC_POSE_STATE_ROOT);
    for (int b = first_from(LC_POSE_GROUP / 4); b < layout.n_bones; b += LC_POSE_GROUP)
      vstore8(bone_motion(b, root, chain), b, motions);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (id == 0) {
    const float most = (float)largest_of(LC_POSE_MOVED, chain.moved_px);
    told[LC_POSE_RESULT_TAKEN(layout)] = taken;
    told[LC_POSE_RESULT_STATUS(layout)] = status;
    told[LC_POSE_RESULT_ROUND(layout)] = steps.round;
    results[LC_POSE_RESULT_MOVED(layout)] = most;
    moved[0] = together && status == LC_POSE_SOLVED ? most : -1.0f;
    if (next[1] || chosen[1] || chosen[3] || chosen[5]) told[LC_POSE_RESULT_GAVE_UP(layout)] = 1;
    next[0] = chosen[0] = chosen[2] = chosen[4] = 0;
  }
#else
  }
#endif
}

// Over the entries of gram [n_tiles][8][8].
kernel void pose_sum_parts(int n, int n_parts, global const float* restrict parts, global float* restrict gram) {
  const int i = get_global_id(0);
  if (i >= n) return;
  float sum = 0.0f;
#pragma unroll 8
  for (int p = 0; p < n_parts; ++p) sum += parts[p * n + i];
  gram[i] = sum;
}

#endif
