// Spreads row records over the columns: J[row][column] = sum over bones that the column's joint moves of
// axis . torque + moment . force; the residual goes to column n_unknowns. A block of neighbouring columns at a time.
#include "pose/layout.h"
#include "shared/bits.h"
#include "shared/wide.h"

#if LC_CPU
typedef float16 columns_t;
typedef int16 column_ids_t;
#define LOAD_COLUMNS vload16
#define FIRST_IDS (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
typedef float8 columns_t;
typedef int8 column_ids_t;
// All columns lie at multiples of 16 bytes, which vload8 does not know.
#define LOAD_COLUMNS(i, from) \
  (float8)(((LC_POSE_SPACE const float4*)(from))[2 * (i)], ((LC_POSE_SPACE const float4*)(from))[2 * (i) + 1])
#define FIRST_IDS (int8)(0, 1, 2, 3, 4, 5, 6, 7)
#endif
#define FILL_COLUMNS LC_POSE_FILL_COLUMNS(LC_CPU)

// What is not static PoCL 3.1 calls, arguments in memory; within gauss_newton.cl, where the tests run the bodies for
// GPUs, it makes wrong code of these when they are. Elsewhere such a function need not exist (C99 6.7.4).
#if LC_POCL && !LC_CPU
#define COLUMNS_FN inline
#else
#define COLUMNS_FN static inline
#endif

// Wrench w (6 floats, `stride` apart) turned about the columns. step: layout.h, offset to the first of them.
COLUMNS_FN columns_t turned(LC_POSE_SPACE const float* restrict w, int stride, LC_POSE_SPACE const float* restrict step,
                            int n_columns) {
  return LOAD_COLUMNS(0, step) * w[0] + LOAD_COLUMNS(0, step + n_columns) * w[stride] +
         LOAD_COLUMNS(0, step + 2 * n_columns) * w[2 * stride] + LOAD_COLUMNS(0, step + 3 * n_columns) * w[3 * stride] +
         LOAD_COLUMNS(0, step + 4 * n_columns) * w[4 * stride] + LOAD_COLUMNS(0, step + 5 * n_columns) * w[5 * stride];
}

// A row with one bone and extra coefficients, from column `column` on. moves [n_bones*n_columns]: 1 where the column
// moves the bone, else 0. records [LC_POSE_RECORD*n_rows], residuals [n_rows].
COLUMNS_FN columns_t point_columns(PoseLayout layout, int row, int column, LC_POSE_SPACE const float* restrict step,
                                   LC_POSE_SPACE const float* restrict moves,
                                   LC_POSE_SPACE const float* restrict records,
                                   LC_POSE_SPACE const float* restrict residuals) {
  const int n_columns = layout.n_columns;
  const column_ids_t columns = column + FIRST_IDS;
  LC_POSE_SPACE const float* record = records + row * LC_POSE_RECORD;
  const int bone = as_int(record[LC_POSE_RECORD_BONES]);
  const column_ids_t extra = columns - as_int(record[LC_POSE_RECORD_EXTRA_COLUMN]);
  columns_t value = LOAD_COLUMNS(0, moves + bone * n_columns + column) * turned(record, 1, step + column, n_columns);
  value += select((columns_t)(0.0f), (columns_t)(record[LC_POSE_RECORD_EXTRA]), extra == 0);
  value += select((columns_t)(0.0f), (columns_t)(record[LC_POSE_RECORD_EXTRA + 1]), extra == 1);
  value += select((columns_t)(0.0f), (columns_t)(record[LC_POSE_RECORD_EXTRA + 2]), extra == 2);
  return select(value, (columns_t)(residuals[row]), columns == layout.n_unknowns);
}

// A row with four bones; `per_vertex` rows of each vertex.
COLUMNS_FN columns_t skinned_columns(PoseLayout layout, int row, int per_vertex, int column,
                                     LC_POSE_SPACE const float* restrict step,
                                     LC_POSE_SPACE const float* restrict moves,
                                     LC_POSE_SPACE const float* restrict records,
                                     LC_POSE_SPACE const float* restrict residuals) {
  const int n_columns = layout.n_columns;
  const column_ids_t columns = column + FIRST_IDS;
  const int vertex = row / per_vertex;
  const int slice = vertex / LC_POSE_SLICE * per_vertex + row % per_vertex;
  LC_POSE_SPACE const float* record = records + slice * LC_POSE_SLICE * LC_POSE_RECORD + vertex % LC_POSE_SLICE;
  const int bones = as_int(record[LC_POSE_RECORD_BONES * LC_POSE_SLICE]);
  columns_t value = 0.0f;
#pragma unroll
  for (int j = 0; j < 4; ++j) {
    const int bone = bones >> (8 * j) & 255;
    if (bone == LC_POSE_NO_BONE) continue;
    const columns_t moved = LOAD_COLUMNS(0, moves + bone * n_columns + column);
#if LC_CPU
    if (!any_of_16(moved != 0.0f)) continue;
#endif
    value += moved * turned(record + 6 * j * LC_POSE_SLICE, LC_POSE_SLICE, step + column, n_columns);
  }
  return select(value, (columns_t)(residuals[row]), columns == layout.n_unknowns);
}

#if LC_CPU

// Over (n_columns, n_rows) divided by FILL_COLUMNS and LC_POSE_FILL_ROWS. Out: J [n_rows*n_columns].
kernel void pose_fill_point_rows(PoseLayout layout, int n_rows, global const float* restrict step,
                                 global const float* restrict moves, global const float* restrict records,
                                 global const float* restrict residuals, global float* restrict J) {
  const int column = FILL_COLUMNS * get_global_id(0);
  if (column >= layout.n_columns) return;
  const int first = LC_POSE_FILL_ROWS * get_global_id(1);
  for (int row = first; row < min(first + LC_POSE_FILL_ROWS, n_rows); ++row)
    store16(point_columns(layout, row, column, step, moves, records, residuals), J + row * layout.n_columns + column);
}

// The same, written from row `first_row` of J on.
kernel void pose_fill_skinned_rows(PoseLayout layout, int n_rows, int per_vertex, int first_row,
                                   global const float* restrict step, global const float* restrict moves,
                                   global const float* restrict records, global const float* restrict residuals,
                                   global float* restrict J) {
  const int column = FILL_COLUMNS * get_global_id(0);
  if (column >= layout.n_columns) return;
  const int first = LC_POSE_FILL_ROWS * get_global_id(1);
  for (int row = first; row < min(first + LC_POSE_FILL_ROWS, n_rows); ++row)
    store16(skinned_columns(layout, row, per_vertex, column, step, moves, records, residuals),
            J + (first_row + row) * layout.n_columns + column);
}

#endif
