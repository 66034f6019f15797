// Gauss-Newton steps on GPUs. A work-group makes LC_POSE_GROUP_ROWS rows of J at a time in local memory and their part
// of [J | F]^T [J | F]; the parts are added in order. All steps of a solve are one launch: groups wait for
// the parts that they add and for the sums (gram_parts.h), and each solves for the step by itself, as it does with the
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
#include "shared/tagged.h"
//
#include "pose/fill_rows.cl"
#include "pose/gram_parts.h"

#define ROWS LC_POSE_GROUP_ROWS
#define TAG ((uint)(steps.tag + taken))
#if LC_POSE_TAKES_STEPS
typedef double real64;
typedef double2 real64_pair;
#else
typedef long real64;  // of arguments that are not used
typedef long2 real64_pair;
#endif

// Copies from global to local memory: all that is asked for before the first number is kept is under way at once. A
// work-item asks for COPIED; asked: the first of `from`.
#define COPIED 4
#define COPIES_OF(T)                                                                                   \
  typedef struct {                                                                                     \
    T of[COPIED];                                                                                      \
  } T##_asked;                                                                                         \
  static T##_asked ask_##T(int n, global const T* from) {                                              \
    T##_asked asked;                                                                                   \
    _Pragma("unroll") for (int k = 0; k < COPIED; ++k) {                                               \
      const int i = get_local_id(0) + k * LC_POSE_GROUP;                                               \
      asked.of[k] = i < n ? from[i] : 0;                                                               \
    }                                                                                                  \
    return asked;                                                                                      \
  }                                                                                                    \
  static void keep_##T(int n, T##_asked asked, global const T* from, local T* to) {                    \
    _Pragma("unroll") for (int k = 0; k < COPIED; ++k) {                                               \
      const int i = get_local_id(0) + k * LC_POSE_GROUP;                                               \
      if (i < n) to[i] = asked.of[k];                                                                  \
    }                                                                                                  \
    for (int i = get_local_id(0) + COPIED * LC_POSE_GROUP; i < n; i += LC_POSE_GROUP) to[i] = from[i]; \
  }
COPIES_OF(float)
#if LC_POSE_TAKES_STEPS
COPIES_OF(int)
COPIES_OF(double)
#endif

// steps.most steps from the state in the inputs on (steps.continues: from that in results) and the residuals where they
// end; or, if that is negative, rows, residuals and parts there, by a group for each ROWS rows (without
// LC_POSE_TAKES_STEPS: at `from`). Rows: point rows, then contour, then matches (two each), then shaded vertices, each
// kind from a multiple of ROWS on. Other arguments: layout.h and the functions that are called. Out: results: layout.h;
// moved: how far a keypoint went, px, -1 after a failure; motions [8*n_bones]: dual quaternions where it ended; J
// [n_rows*n_columns]; kept: layout.h, of such a solve and for the next; parts [n_parts][n_tiles][8][8] and their
// sums gram [2][n_tiles][8][8], of even and odd steps, tagged. state: [2], see tagged.h; next, chosen: of the launches
// that follow, set to 0. rows: LC_POSE_ROWS_SIZE floats; near: LC_POSE_NEAR_SIZE; memory: LC_POSE_LOCAL.
kernel __attribute__((reqd_work_group_size(LC_POSE_GROUP, 1, 1))) void pose_gauss_newton(
    PoseLayout layout, float4 camera, PoseContour contour, float keypoint_huber_px, float match_huber_px,
    float shading_huber, float sqrt_anatomic, PoseInputs at, PoseStepsArg steps, global const float* restrict inputs,
    global const real64* restrict constants, global const int* restrict links, global const float* restrict moves,
    global const float* restrict limits, global const float* restrict rest, global const float* restrict rest_normals,
    global const int* restrict bones, global const float* restrict weights, global const float* restrict distance,
    global const float* restrict from, global real64* kept, global float* restrict J, volatile global ulong* parts,
    volatile global ulong* gram, global float* results, volatile global int* state, global float* moved,
    global float* motions, volatile global int* next, volatile global int* chosen, local float4* rows,
    local float4* near, local real64_pair* memory) {
  const int id = get_local_id(0), group = get_group_id(0), n_groups = get_num_groups(0);
  const int n_columns = layout.n_columns, n_point = LC_POSE_POINT_ROWS + 2 * layout.n_dofs + layout.n_soles;
  global const int* counts = (global const int*)(inputs + at.counts);
  const int n_matches = counts[LC_POSE_COUNT_MATCHES], n_shaded = counts[LC_POSE_COUNT_SHADED];
  contour.n = counts[LC_POSE_COUNT_CONTOUR];
  contour.sqrt_weight = inputs[at.counts + LC_POSE_COUNT_CONTOUR_ROOT];
  const int n_of[4] = {n_point, contour.n, 2 * n_matches, n_shaded};
  int n_parts = 0;
  for (int kind = 0; kind < 4; ++kind) n_parts += (n_of[kind] + ROWS - 1) / ROWS;
  global float* residuals = results + LC_POSE_RESULT_RESIDUALS(layout);
  local float* moved_by = (local float*)near;
  local float* step = moved_by + layout.n_bones * n_columns;
  local float* records = step + LC_POSE_STEP_SIZE(layout);
  local float* of_rows = records + ROWS * LC_POSE_RECORD;
  local float* targets = of_rows + ROWS;
  local float* ground = targets + LC_POSE_TARGET * LC_POSE_KEYPOINTS;
  const int n_moves = layout.n_bones * n_columns, n_targets = LC_POSE_TARGET * LC_POSE_KEYPOINTS;
  const int n_ground = LC_POSE_GROUND_STANDS + layout.n_soles;
  const float_asked of_moves = ask_float(n_moves, moves), of_targets = ask_float(n_targets, inputs + at.targets);
  const float_asked of_ground = ask_float(n_ground, inputs + at.ground);
#if LC_POSE_TAKES_STEPS
  (void)from;
  local int given_up, finite[2];
  local double* unknowns = (local double*)memory + LC_POSE_SOLVE_LOCAL(layout);
  local double* chain_memory = unknowns + LC_POSE_STATE_SIZE(layout);
  const Chain chain = chain_in(layout, chain_memory);
  int together = 1, status = LC_POSE_SOLVED, taken = 0, has_chain = 0;
  const int n_state = LC_POSE_STATE_SIZE(layout), n_keypoints = steps.continues ? 3 * LC_POSE_KEYPOINTS : 0;
  const int n_step = steps.continues ? LC_POSE_STEP_SIZE(layout) : 0;
  const int n_constants = LC_POSE_CHAIN_SIZE(layout), n_links = LC_POSE_LINKS_SIZE(layout);
  global const double* state_before = (global const double*)(steps.continues ? results : inputs + at.start);
  global float* kept_step = (global float*)(kept + 3 * LC_POSE_KEYPOINTS);
  const double_asked of_state = ask_double(n_state, state_before), of_keypoints = ask_double(n_keypoints, kept);
  const double_asked of_constants = ask_double(n_constants, constants);
  const float_asked of_step = ask_float(n_step, kept_step);
  const int_asked of_links = ask_int(n_links, links);
  const bool takes_part = group < n_parts || ADDED * group < LC_POSE_GRAM_SIZE(layout);
  if (moved[0] < steps.least_moved_px || !takes_part) return;
  if (id == 0) given_up = 0;
  keep_double(n_state, of_state, state_before, unknowns);
  keep_double(n_keypoints, of_keypoints, kept, chain.keypoints);
  keep_double(n_constants, of_constants, constants, chain.constants);
  keep_float(n_step, of_step, kept_step, step);
  keep_int(n_links, of_links, links, chain.links);
#else
  for (int i = id; i < LC_POSE_STEP_SIZE(layout); i += LC_POSE_GROUP) step[i] = from[i];
#endif
  keep_float(n_moves, of_moves, moves, moved_by);
  keep_float(n_targets, of_targets, inputs + at.targets, targets);
  keep_float(n_ground, of_ground, inputs + at.ground, ground);
  barrier(CLK_LOCAL_MEM_FENCE);
#if LC_POSE_TAKES_STEPS
  start_round(steps.continues, layout, steps, inputs + at.soles_before, chain, (local double*)memory, unknowns, step,
              targets, ground);
  while (true) {
    const bool is_posed = taken == 0 && steps.continues;
    pose_chain(!is_posed, layout, unknowns, chain);
    has_chain |= !is_posed;
    const double moved_px = write_step(!is_posed, layout, camera, unknowns, chain, step);
    // Read at the end, after the barriers of the parts.
    for (int i = id; taken == 0 && i < 3 * LC_POSE_KEYPOINTS; i += LC_POSE_GROUP) chain.start[i] = chain.keypoints[i];
    const int is_last = taken >= steps.most || (taken > 0 && moved_px < steps.settled_px);
    const int counts_rows = !is_last || steps.most < 0, n_made = is_last && !steps.tells ? 0 : n_parts;
#else
  (void)constants, (void)kept, (void)gram, (void)state, (void)memory, (void)moved, (void)motions, (void)next,
      (void)chosen;
  const int counts_rows = 1, n_made = n_parts, taken = 0;
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
                          (global const int*)(inputs + at.contour_vertices), rest, rest_normals, bones, weights,
                          distance, records, of_rows);
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
      if (counts_rows)
        gram_of_rows(n_columns, (local const float2*)rows, TAG, parts + part * LC_POSE_GRAM_SIZE(layout));
      barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    }
#if LC_POSE_TAKES_STEPS
    if (is_last) break;
    // Of two steps on end: some groups may still read the last sum. No group is two behind, since each makes parts
    // or sums that all others wait for.
    volatile global ulong* sum = gram + TAG % 2 * LC_POSE_GRAM_SIZE(layout);
    add_parts(LC_POSE_GRAM_SIZE(layout), n_parts, parts, TAG, sum, state, &given_up, (local float*)rows);
    together = take_gram(LC_POSE_GRAM_SIZE(layout), sum, TAG, state, &given_up, (local float*)rows);
    if (group == 0 && id == 0)
      results[LC_POSE_RESULT_ENERGY(layout) + taken] =
          gram_entry(layout, (local const float*)rows, layout.n_unknowns, layout.n_unknowns);
    status = damped_step(layout, steps, (local const float*)rows, (local double*)memory, finite, unknowns);
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

// Over the entries of gram [n_tiles][8][8], not tagged.
kernel void pose_sum_parts(int n, int n_parts, global const ulong* restrict parts, global float* restrict gram) {
  const int i = get_global_id(0);
  if (i >= n) return;
  float sum = 0.0f;
#pragma unroll 8
  for (int p = 0; p < n_parts; ++p) sum += untagged(parts[p * n + i]);
  gram[i] = sum;
}

#endif
