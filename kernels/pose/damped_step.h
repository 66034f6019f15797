// A Gauss-Newton step on the device, in double: what src/pose/pose_solver.cpp does with src/solve/dense_solver.h. By
// one work-group of LC_POSE_GROUP, 16 x 16 work-items: each keeps every sixteenth entry of the system, along rows and
// columns, in registers, and only the rows and columns of the pivots go through local memory. Elimination needs no
// search for pivots: the system is positive definite. Two at a time, since what takes the time is one step after
// another.
#ifndef LC_POSE_DAMPED_STEP_H
#define LC_POSE_DAMPED_STEP_H
#include "pose/chain.h"
#if LC_POSE_TAKES_STEPS

#define SIDE LC_POSE_SYSTEM_SIDE
#define SHARE (SIDE / 16)  // of a work-item, along rows and columns

// The system with a unit diagonal: row and column 16 * a + get_local_id(0) / 16 and 16 * b + get_local_id(0) % 16. The
// right-hand side is column n_eliminated(). Unknowns from n_unknowns on have rows of the unit matrix.
typedef struct {
  double of[SHARE][SHARE];
} SystemPart;

// In local memory, [LC_POSE_SOLVE_LOCAL].
typedef struct {
  local double* scale;     // [SIDE] of the unknowns
  local double* diagonal;  // [SIDE] damped, before scaling
  local double* pivots;    // [SIDE] of L D L^T
  local double* step;      // [SIDE]
  local double* turned;    // [SIDE] by how much joints turn
  local double* lines;     // [2][4][SIDE] two rows and two columns, of this pivot and the one before
  local int* finite;       // [2] whether the system and its solution are
} Solve;

static Solve solve_in(local double* memory, local int* finite) {
  const Solve s = {memory, memory + SIDE, memory + 2 * SIDE, memory + 3 * SIDE, memory + 4 * SIDE, memory + 5 * SIDE,
                   finite};
  return s;
}

// Entry of gram.cl's tiles.
static float gram_entry(PoseLayout layout, global const float* gram, int i, int j) {
  const int row = min(i, j), column = max(i, j), side = layout.n_columns / 8, a = row / 8;
  const int tile = a * side - a * (a - 1) / 2 + column / 8 - a;
  return gram[64 * tile + row % 8 * 8 + column % 8];
}

static bool is_angle(PoseLayout layout, int i) {
  return i < 3 || (i >= 6 && i < layout.n_unknowns - 3);
}

static int n_eliminated(PoseLayout layout) {
  return (layout.n_unknowns + 1) / 2 * 2;
}

// Reads the normal equations, damps and scales them.
static void damped_system(PoseLayout layout, PoseStepsArg steps, global const float* gram, Solve s, SystemPart* part) {
  const int id = get_local_id(0), n = layout.n_unknowns, right = n_eliminated(layout);
  local float* own = (local float*)s.lines;
  float entries[SHARE][SHARE];
#pragma unroll
  for (int a = 0; a < SHARE; ++a) {
#pragma unroll
    for (int b = 0; b < SHARE; ++b) {
      const int i = 16 * a + id / 16, j = 16 * b + id % 16;
      entries[a][b] = i < n && (j < n || j == right) ? gram_entry(layout, gram, i, min(j, n)) : 0.0f;
    }
  }
  for (int i = id; i < SIDE; i += LC_POSE_GROUP) own[i] = i < n ? gram_entry(layout, gram, i, i) : 0.0f;
  if (id < 2) s.finite[id] = 1;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = id; i < n; i += LC_POSE_GROUP) {
    float largest = 0.0f;
#pragma unroll
    for (int j = 0; j < SIDE; ++j)
      largest = is_angle(layout, j) == is_angle(layout, i) ? fmax(largest, own[j]) : largest;
    const double damped = own[i] + steps.damping_own * (double)own[i] + steps.damping_largest * (double)largest;
    s.diagonal[i] = damped;
    s.scale[i] = damped > 0.0 ? 1.0 / sqrt(damped) : 0.0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
#pragma unroll
  for (int a = 0; a < SHARE; ++a) {
#pragma unroll
    for (int b = 0; b < SHARE; ++b) {
      const int i = 16 * a + id / 16, j = 16 * b + id % 16;
      const double entry = i == j && i < n ? s.diagonal[i] : (double)entries[a][b];
      if (!isfinite(entry)) s.finite[0] = 0;
      const double left = i < n ? s.scale[i] : 0.0, above = j < n ? s.scale[j] : -1.0;
      part->of[a][b] = i == j && left == 0.0 ? 1.0 : left * entry * above;
    }
  }
}

// 1 / x: a float's, made exact by Newton's method, which takes less long than a division of doubles.
static double inverse_of(double x) {
  double inverse = 1.0f / (float)x;
  inverse += inverse * fma(-x, inverse, 1.0);
  return inverse + inverse * fma(-x, inverse, 1.0);
}

// Gauss-Jordan: the right-hand side becomes the solution. Pivots: every second one times the one before.
static void eliminate(int n, Solve s, SystemPart* part) {
  const int tx = get_local_id(0) % 16, ty = get_local_id(0) / 16;
  for (int k = 0; k < n; k += 2) {
    local double* rows = s.lines + k / 2 % 2 * 4 * SIDE;
    local double* columns = rows + 2 * SIDE;
#pragma unroll
    for (int a = 0; a < SHARE; ++a) {
      if (a != k / 16) continue;
#pragma unroll
      for (int b = 0; b < SHARE; ++b) {
        if (ty / 2 == k % 16 / 2) rows[ty % 2 * SIDE + 16 * b + tx] = part->of[a][b];
        if (tx / 2 == k % 16 / 2) columns[tx % 2 * SIDE + 16 * b + ty] = part->of[b][a];
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const double xx = rows[k], xy = rows[k + 1], yx = rows[SIDE + k], yy = rows[SIDE + k + 1];
    const double determinant = xx * yy - xy * yx, inverse = inverse_of(determinant);
    if (get_local_id(0) < 2) s.pivots[k + get_local_id(0)] = get_local_id(0) == 0 ? xx : determinant;
    double of_first[SHARE], of_second[SHARE];
#pragma unroll
    for (int a = 0; a < SHARE; ++a) {
      const int row = 16 * a + ty;
      // Rows of pivots are what is left when they are taken from nothing, by the inverse.
      const bool has_pivot = row / 2 == k / 2;
      const double x = has_pivot ? (row == k ? -1.0 : 0.0) : columns[row];
      const double y = has_pivot ? (row == k ? 0.0 : -1.0) : columns[SIDE + row];
      of_first[a] = (x * yy - y * yx) * inverse;
      of_second[a] = (y * xx - x * xy) * inverse;
    }
#pragma unroll
    for (int b = 0; b < SHARE; ++b) {
      if (b < k / 16) continue;  // done with
      const double first = rows[16 * b + tx], second = rows[SIDE + 16 * b + tx];
#pragma unroll
      for (int a = 0; a < SHARE; ++a) {
        const double from = (16 * a + ty) / 2 == k / 2 ? 0.0 : part->of[a][b];
        part->of[a][b] = from - of_first[a] * first - of_second[a] * second;
      }
    }
  }
}

static bool has_full_rank(int n, float threshold, local const double* pivots) {
  double2 least = INFINITY, most = 0.0;
#pragma unroll 8
  for (int k = 0; k < n; k += 2) {
    const double2 v = vload2(0, pivots + k);
    least = v < least ? v : least;
    most = most < v ? v : most;
  }
  return fmin(least.x, least.y) > threshold * fmax(most.x, most.y);
}

// Adds the step of the normal equations `gram` to the state (layout.h). finite: [2]. Returns LC_POSE_SOLVED, or why
// the state is as it was.
static int damped_step(PoseLayout layout, PoseStepsArg steps, global const float* gram, local double* memory,
                       local int* finite, local double* state) {
  const int id = get_local_id(0), n = layout.n_unknowns, right = n_eliminated(layout);
  const Solve s = solve_in(memory, finite);
  SystemPart part;
  damped_system(layout, steps, gram, s, &part);
  eliminate(right, s, &part);
#pragma unroll
  for (int a = 0; a < SHARE; ++a) {
#pragma unroll
    for (int b = 0; b < SHARE; ++b) {
      const int i = 16 * a + id / 16;
      if (16 * b + id % 16 != right) continue;
      const double step = i < n ? s.scale[i] * part.of[a][b] : 0.0;
      s.step[i] = step;
      s.turned[i] = i >= 6 && i < n - 3 ? fabs(step) : 0.0;
      if (!isfinite(step)) s.finite[1] = 0;
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int k = 1 + 2 * id; k < right; k += 2 * LC_POSE_GROUP) s.pivots[k] /= s.pivots[k - 1];
  barrier(CLK_LOCAL_MEM_FENCE);
  const int status = !s.finite[0]                                            ? LC_POSE_NOT_FINITE
                     : !has_full_rank(right, steps.rank_threshold, s.pivots) ? LC_POSE_RANK_DEFICIENT
                     : !s.finite[1]                                          ? LC_POSE_NOT_FINITE
                                                                             : LC_POSE_SOLVED;
  // Shortened so that nothing turns further than the bound.
  double3 turn = vload3(0, s.step);
  double angle = sqrt(dot(turn, turn)), factor = 1.0;
  const double largest = fmax(angle, largest_of(SIDE, s.turned));
  if (steps.max_step_rad > 0.0f && largest > steps.max_step_rad) factor = steps.max_step_rad / largest;
  // Behind the quaternion the state is in the order of the unknowns.
  for (int i = 3 + id; status == LC_POSE_SOLVED && i < n; i += LC_POSE_GROUP) state[i + 1] += factor * s.step[i];
  if (id == LC_POSE_GROUP - 1 && status == LC_POSE_SOLVED && factor * angle >= 1e-12) {
    const double4 q = quat_product(quat_about(turn / angle, factor * angle), vload4(0, state));
    vstore4(q / sqrt(dot(q, q)), 0, state);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return status;
}

#endif
#endif
