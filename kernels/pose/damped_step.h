// A Gauss-Newton step on the device, in double: what src/pose/pose_solver.cpp does with src/solve/dense_solver.h. By
// one work-group of LC_POSE_GROUP. Elimination needs no pivots: the system is positive definite.
#ifndef LC_POSE_DAMPED_STEP_H
#define LC_POSE_DAMPED_STEP_H
#include "pose/chain.h"
#if LC_POSE_TAKES_STEPS

// Entry of gram.cl's tiles.
static double gram_entry(PoseLayout layout, global const float* gram, int i, int j) {
  const int row = min(i, j), column = max(i, j), side = layout.n_columns / 8, a = row / 8;
  const int tile = a * side - a * (a - 1) / 2 + column / 8 - a;
  return gram[64 * tile + row % 8 * 8 + column % 8];
}

static bool is_angle(PoseLayout layout, int i) {
  return i < 3 || (i >= 6 && i < layout.n_unknowns - 3);
}

// The scaled system with its right-hand side, [n_unknowns][n_unknowns + 1]. scale, diagonal: [n_unknowns]. finite:
// whether all of it is, set before.
static void damped_system(PoseLayout layout, PoseStepsArg steps, global const float* gram, local double* system,
                          local double* scale, local double* diagonal, local int* finite) {
  const int id = get_local_id(0), n = layout.n_unknowns;
  for (int i = id; i < n; i += LC_POSE_GROUP) scale[i] = gram_entry(layout, gram, i, i);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = id; i < n; i += LC_POSE_GROUP) {
    double largest = 0.0;
    for (int j = 0; j < n; ++j)
      if (is_angle(layout, j) == is_angle(layout, i) && scale[j] > largest) largest = scale[j];
    diagonal[i] = scale[i] + steps.damping_own * scale[i] + steps.damping_largest * largest;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = id; i < n; i += LC_POSE_GROUP) scale[i] = diagonal[i] > 0.0 ? 1.0 / sqrt(diagonal[i]) : 0.0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int at = id; at < n * (n + 1); at += LC_POSE_GROUP) {
    const int i = at / (n + 1), j = at % (n + 1);
    const double entry = i == j ? diagonal[i] : gram_entry(layout, gram, i, j);
    if (!isfinite(entry)) *finite = 0;
    const double scaled = scale[i] * entry * (j < n ? scale[j] : -1.0);
    system[at] = i == j && scale[i] == 0.0 ? 1.0 : scaled;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// Gauss-Jordan: columns to the right of the diagonal, the last of which becomes pivots times solution.
static void eliminate(int n, local double* system) {
  const int lane = get_local_id(0) % 32, first = get_local_id(0) / 32, width = n + 1;
  for (int k = 0; k < n; ++k) {
    const double inverse = 1.0 / system[k * width + k];
    for (int i = first; i < n; i += LC_POSE_GROUP / 32) {
      if (i == k) continue;
      const double factor = system[i * width + k] * inverse;
      for (int j = k + 1 + lane; j < width; j += 32) system[i * width + j] -= factor * system[k * width + j];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
}

// Shortens the step so that nothing turns further than the bound: by which factor.
static double turn_factor(PoseLayout layout, float max_step_rad, local const double* step) {
  if (!(max_step_rad > 0.0f)) return 1.0;
  double largest = length(vload3(0, step));
  for (int i = 6; i < layout.n_unknowns - 3; ++i) largest = fmax(largest, fabs(step[i]));
  return largest > max_step_rad ? max_step_rad / largest : 1.0;
}

// Adds the step of the normal equations `gram` to the state (layout.h). memory: [LC_POSE_SOLVE_LOCAL]. Returns
// LC_POSE_SOLVED, or why the state is as it was.
static int damped_step(PoseLayout layout, PoseStepsArg steps, global const float* gram, local double* memory,
                       local int* finite, local double* state) {
  const int id = get_local_id(0), n = layout.n_unknowns;
  local double* scale = memory;
  local double* step = scale + n;
  local double* system = step + n;
  if (id == 0) *finite = 1;
  damped_system(layout, steps, gram, system, scale, step, finite);
  eliminate(n, system);
  double least = INFINITY, most = -INFINITY;
  for (int i = 0; i < n; ++i) {
    least = fmin(least, system[i * (n + 2)]);
    most = fmax(most, system[i * (n + 2)]);
  }
  const bool full_rank = least > steps.rank_threshold * most;
  for (int i = id; i < n; i += LC_POSE_GROUP) {
    step[i] = scale[i] * system[i * (n + 1) + n] / system[i * (n + 2)];
    if (full_rank && !isfinite(step[i])) *finite = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int status = !*finite ? LC_POSE_NOT_FINITE : full_rank ? LC_POSE_SOLVED : LC_POSE_RANK_DEFICIENT;
  const double factor = turn_factor(layout, steps.max_step_rad, step);
  // Behind the quaternion the state is in the order of the unknowns.
  for (int i = 3 + id; status == LC_POSE_SOLVED && i < n; i += LC_POSE_GROUP) state[i + 1] += factor * step[i];
  const double3 turn = factor * vload3(0, step);
  const double angle = length(turn);
  if (id == 0 && status == LC_POSE_SOLVED && angle >= 1e-12)
    vstore4(normalize(quat_product(quat_about(turn / angle, angle), vload4(0, state))), 0, state);
  barrier(CLK_LOCAL_MEM_FENCE);
  return status;
}

#endif
#endif
