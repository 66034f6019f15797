// Spreads row records over the columns: J[row][column] = sum over bones that the column's joint moves of
// axis . torque + moment . force; the residual goes to column n_unknowns. A work-item makes LC_POSE_FILL_COLUMNS
// columns of LC_POSE_FILL_ROWS rows: launch over (n_columns, n_rows) divided by these.
#include "pose/layout.h"
#include "shared/wide.h"

#define ROWS LC_POSE_FILL_ROWS(LC_CPU)
#if LC_CPU
typedef float16 columns_t;
typedef int16 column_ids_t;
#define LOAD_COLUMNS vload16
#define STORE_COLUMNS store16
#define FIRST_IDS (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
typedef float8 columns_t;
typedef int8 column_ids_t;
#define LOAD_COLUMNS vload8
#define STORE_COLUMNS store8
#define FIRST_IDS (int8)(0, 1, 2, 3, 4, 5, 6, 7)
#endif

// Wrench w (6 floats, `stride` apart) turned about the columns. step: layout.h, offset to the first of them.
inline columns_t turned(global const float* restrict w, int stride, global const float* restrict step, int n_columns) {
  return LOAD_COLUMNS(0, step) * w[0] + LOAD_COLUMNS(0, step + n_columns) * w[stride] +
         LOAD_COLUMNS(0, step + 2 * n_columns) * w[2 * stride] + LOAD_COLUMNS(0, step + 3 * n_columns) * w[3 * stride] +
         LOAD_COLUMNS(0, step + 4 * n_columns) * w[4 * stride] + LOAD_COLUMNS(0, step + 5 * n_columns) * w[5 * stride];
}

// Rows with one bone and extra coefficients. moves [n_bones*n_columns]: 1 where the column moves the bone, else 0.
// records [LC_POSE_RECORD*n_rows], residuals [n_rows]. Out: J [n_rows*n_columns].
kernel void pose_fill_point_rows(PoseLayout layout, int n_rows, global const float* restrict step,
                                 global const float* restrict moves, global const float* restrict records,
                                 global const float* restrict residuals, global float* restrict J) {
  const int n_columns = layout.n_columns;
  const int column = LC_POSE_FILL_COLUMNS(LC_CPU) * get_global_id(0);
  if (column >= n_columns) return;
  const column_ids_t columns = column + FIRST_IDS;
  const int first = ROWS * get_global_id(1);
  for (int row = first; row < min(first + ROWS, n_rows); ++row) {
    global const float* record = records + row * LC_POSE_RECORD;
    const int bone = as_int(record[LC_POSE_RECORD_BONES]);
    const column_ids_t extra = columns - as_int(record[LC_POSE_RECORD_EXTRA_COLUMN]);
    columns_t value = LOAD_COLUMNS(0, moves + bone * n_columns + column) * turned(record, 1, step + column, n_columns);
    value += select((columns_t)(0.0f), (columns_t)(record[LC_POSE_RECORD_EXTRA]), extra == 0);
    value += select((columns_t)(0.0f), (columns_t)(record[LC_POSE_RECORD_EXTRA + 1]), extra == 1);
    value += select((columns_t)(0.0f), (columns_t)(record[LC_POSE_RECORD_EXTRA + 2]), extra == 2);
    STORE_COLUMNS(select(value, (columns_t)(residuals[row]), columns == layout.n_unknowns),
                  J + row * n_columns + column);
  }
}

// Rows with four bones, `per_vertex` of each vertex, written from row `first_row` of J on.
kernel void pose_fill_skinned_rows(PoseLayout layout, int n_rows, int per_vertex, int first_row,
                                   global const float* restrict step, global const float* restrict moves,
                                   global const float* restrict records, global const float* restrict residuals,
                                   global float* restrict J) {
  const int n_columns = layout.n_columns;
  const int column = LC_POSE_FILL_COLUMNS(LC_CPU) * get_global_id(0);
  if (column >= n_columns) return;
  const column_ids_t columns = column + FIRST_IDS;
  const int first = ROWS * get_global_id(1);
  for (int row = first; row < min(first + ROWS, n_rows); ++row) {
    const int vertex = row / per_vertex;
    const int slice = vertex / LC_POSE_SLICE * per_vertex + row % per_vertex;
    global const float* record = records + slice * LC_POSE_SLICE * LC_POSE_RECORD + vertex % LC_POSE_SLICE;
    const int bones = as_int(record[LC_POSE_RECORD_BONES * LC_POSE_SLICE]);
    columns_t value = 0.0f;
#pragma unroll
    for (int j = 0; j < 4; ++j) {
      const int bone = bones >> (8 * j) & 255;
      value += LOAD_COLUMNS(0, moves + bone * n_columns + column) *
               turned(record + 6 * j * LC_POSE_SLICE, LC_POSE_SLICE, step + column, n_columns);
    }
    STORE_COLUMNS(select(value, (columns_t)(residuals[row]), columns == layout.n_unknowns),
                  J + (first_row + row) * n_columns + column);
  }
}
