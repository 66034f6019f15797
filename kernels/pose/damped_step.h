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
  local double* lines;     // [2][2][SIDE][2] two rows, two columns, of this turn and the last; then maxima, pivots
  local int* finite;       // [2] whether the system and its solution are
} Solve;

static Solve solve_in(local double* memory, local int* finite) {
  const Solve s = {memory, memory + SIDE, memory + 2 * SIDE, memory + 3 * SIDE, memory + 4 * SIDE, finite};
  return s;
}

// Where gram.cl's tiles have row i and column j: entry (i, j), i <= j, is at the sum of both.
static int gram_row(PoseLayout layout, int i) {
  const int side = layout.n_columns / 8, a = i / 8;
  return 64 * (a * side - a * (a - 1) / 2 - a) + i % 8 * 8;
}

static int gram_column(int j) {
  return 64 * (j / 8) + j % 8;
}

static float gram_entry(PoseLayout layout, local const float* gram, int i, int j) {
  return gram[gram_row(layout, min(i, j)) + gram_column(max(i, j))];
}

static bool is_angle(PoseLayout layout, int i) {
  return i < 3 || (i >= 6 && i < layout.n_unknowns - 3);
}

static int n_eliminated(PoseLayout layout) {
  return (layout.n_unknowns + 1) / 2 * 2;
}

// Reads the normal equations, damps and scales them.
static void damped_system(PoseLayout layout, PoseStepsArg steps, local const float* gram, Solve s, SystemPart* part) {
  const int id = get_local_id(0), n = layout.n_unknowns, right = n_eliminated(layout);
  local float* own = (local float*)s.lines;
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
  double above[SHARE];
  int rows[SHARE], columns[SHARE];  // of the entry's column as well, where that is above
#pragma unroll
  for (int b = 0; b < SHARE; ++b) {
    const int j = 16 * b + id % 16;
    above[b] = j < n ? s.scale[j] : -1.0;
    rows[b] = gram_row(layout, min(j, n));
    columns[b] = gram_column(min(j, n));
  }
#pragma unroll
  for (int a = 0; a < SHARE; ++a) {
    const int i = 16 * a + id / 16, row = gram_row(layout, i), column = gram_column(i);
    const double left = i < n ? s.scale[i] : 0.0;
#pragma unroll
    for (int b = 0; b < SHARE; ++b) {
      const int j = 16 * b + id % 16;
      const bool is_there = i < n && (j < n || j == right);
      const double entry = !is_there ? 0.0
                           : i == j  ? s.diagonal[i]
                                     : (double)gram[i < j ? row + columns[b] : rows[b] + column];
      if (!isfinite(entry)) s.finite[0] = 0;
      part->of[a][b] = i == j && left == 0.0 ? 1.0 : left * entry * above[b];
    }
  }
}

// 1 / x: nearly, made exact by Newton's method, which takes less long than a division of doubles.
static double inverse_of(double x) {
#ifdef __NV_CL_C_VERSION
  double inverse;
  asm("rcp.approx.ftz.f64 %0, %1;" : "=d"(inverse) : "d"(x));
#else
  double inverse = 1.0f / (float)x;
#endif
  inverse += inverse * fma(-x, inverse, 1.0);
  return inverse + inverse * fma(-x, inverse, 1.0);
}

// Gauss-Jordan: the right-hand side becomes the solution. Pivots: every second one times the one before. Which of its
// entries a work-item needs is known when this is compiled: SHARE loops of 8 turns each, or up to the
// last unknown: what a loop up to a constant writes to local memory PoCL's code loses.
static void eliminate(int n, Solve s, SystemPart* part) {
  const int tx = get_local_id(0) % 16, ty = get_local_id(0) / 16;
#ifdef __NV_CL_C_VERSION  // PoCL takes minutes for it
#pragma unroll
#endif
  for (int of = 0; of < SHARE; ++of) {
    const int turns = min(n / 2 - 8 * of, 8);
#pragma unroll 1
    for (int turn = 0; turn < turns; ++turn) {
      const int k = 16 * of + 2 * turn;
      local double2* rows = (local double2*)s.lines + turn % 2 * 2 * SIDE;
      local double2* columns = rows + SIDE;
      const bool has_row = ty / 2 == turn, has_column = tx / 2 == turn;
#pragma unroll
      for (int b = of; b < SHARE; ++b)
        if (has_row) ((local double*)(rows + 16 * b + tx))[ty % 2] = part->of[of][b];
#pragma unroll
      for (int a = 0; a < SHARE; ++a)
        if (has_column) ((local double*)(columns + 16 * a + ty))[tx % 2] = part->of[a][of];
      barrier(CLK_LOCAL_MEM_FENCE);
      const double2 first = rows[k], second = rows[k + 1];
      const double xx = first.x, xy = second.x, yx = first.y, yy = second.y;
      const double determinant = xx * yy - xy * yx, inverse = inverse_of(determinant);
      if (get_local_id(0) < 2) s.pivots[k + get_local_id(0)] = get_local_id(0) == 0 ? xx : determinant;
      double of_first[SHARE], of_second[SHARE];
#pragma unroll
      for (int a = 0; a < SHARE; ++a) {
        double2 column = columns[16 * a + ty];
        // Rows of pivots are what is left when they are taken from nothing, by the inverse.
        if (a == of && has_row) column = ty % 2 ? (double2)(0.0, -1.0) : (double2)(-1.0, 0.0);
        of_first[a] = (column.x * yy - column.y * yx) * inverse;
        of_second[a] = (column.y * xx - column.x * xy) * inverse;
      }
#pragma unroll
      for (int b = of; b < SHARE; ++b) {
        const double2 row = rows[16 * b + tx];
#pragma unroll
        for (int a = 0; a < SHARE; ++a) {
          const double from = a == of && has_row ? 0.0 : part->of[a][b];
          part->of[a][b] = from - of_first[a] * row.x - of_second[a] * row.y;
        }
      }
    }
  }
}

// Adds the step of the normal equations `gram` to the state (layout.h). finite: [2]. Returns LC_POSE_SOLVED, or why
// the state is as it was.
static int damped_step(PoseLayout layout, PoseStepsArg steps, local const float* gram, local double* memory,
                       local int* finite, local double* state) {
  const int id = get_local_id(0), n = layout.n_unknowns, right = n_eliminated(layout);
  const Solve s = solve_in(memory, finite);
  SystemPart part;
  damped_system(layout, steps, gram, s, &part);
  eliminate(right, s, &part);
  // Of 16 work-items the most that a joint turns; of two pivots each the least and the largest.
  local double* turned = s.lines;
  local double* least = turned + 16;
  local double* most = least + SIDE / 2;
  barrier(CLK_LOCAL_MEM_FENCE);
#pragma unroll
  for (int b = 0; b < SHARE; ++b) {
    if (16 * b + id % 16 != right) continue;
    double largest = 0.0;
#pragma unroll
    for (int a = 0; a < SHARE; ++a) {
      const int i = 16 * a + id / 16;
      const double step = i < n ? s.scale[i] * part.of[a][b] : 0.0;
      s.step[i] = step;
      largest = i >= 6 && i < n - 3 ? fmax(largest, fabs(step)) : largest;
      if (!isfinite(step)) s.finite[1] = 0;
    }
    turned[id / 16] = largest;
  }
  const int pair = id - 32;  // by another warp
  if (pair >= 0 && pair < SIDE / 2) {
    const bool is_there = 2 * pair < right;
    const double first = is_there ? s.pivots[2 * pair] : 1.0;
    const double second = is_there ? s.pivots[2 * pair + 1] / first : 1.0;
    least[pair] = !is_there ? INFINITY : second < first ? second : first;
    most[pair] = !is_there ? 0.0 : second > first ? second : first;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  double low = INFINITY;
#pragma unroll 4
  for (int k = 0; k < SIDE / 2; ++k) low = least[k] < low ? least[k] : low;
  const int status = !s.finite[0]                                                 ? LC_POSE_NOT_FINITE
                     : !(low > steps.rank_threshold * largest_of(SIDE / 2, most)) ? LC_POSE_RANK_DEFICIENT
                     : !s.finite[1]                                               ? LC_POSE_NOT_FINITE
                                                                                  : LC_POSE_SOLVED;
  // Shortened so that nothing turns further than the bound.
  double3 turn = vload3(0, s.step);
  double angle = sqrt(dot(turn, turn)), factor = 1.0;
  const double largest = fmax(angle, largest_of(16, turned));
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
