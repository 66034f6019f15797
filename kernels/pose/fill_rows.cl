// Spreads row records over the columns: J[row][column] = sum over bones that the column's joint moves of
// axis . torque + moment . force; the residual goes to column n_unknowns. A work-item makes eight columns of one row:
// launch over (n_columns / 8, n_rows).
#include "pose/layout.h"

// The eight columns of a work-item.
inline int8 column_ids(int block) {
  return 8 * block + (int8)(0, 1, 2, 3, 4, 5, 6, 7);
}

// Wrench w (6 floats) turned about eight columns. step: layout.h, offset to the first of them.
inline float8 turned(global const float* restrict w, global const float* restrict step, int n_columns) {
  return vload8(0, step) * w[0] + vload8(0, step + n_columns) * w[1] + vload8(0, step + 2 * n_columns) * w[2] +
         vload8(0, step + 3 * n_columns) * w[3] + vload8(0, step + 4 * n_columns) * w[4] +
         vload8(0, step + 5 * n_columns) * w[5];
}

// Rows with one bone and extra coefficients. moves [n_bones*n_columns]: 1 where the column moves the bone, else 0.
// records [LC_POSE_RECORD*n_rows], residuals [n_rows]. Out: J [n_rows*n_columns].
kernel void pose_fill_point_rows(PoseLayout layout, int n_rows, global const float* restrict step,
                                 global const float* restrict moves, global const float* restrict records,
                                 global const float* restrict residuals, global float* restrict J) {
  const int block = get_global_id(0);
  const int row = get_global_id(1);
  const int n_columns = layout.n_columns;
  if (8 * block >= n_columns || row >= n_rows) return;
  global const float* record = records + row * LC_POSE_RECORD;
  const int bone = as_int(record[LC_POSE_RECORD_BONES]);
  const int8 columns = column_ids(block);
  const int8 extra = columns - as_int(record[LC_POSE_RECORD_EXTRA_COLUMN]);
  float8 value = vload8(block, moves + bone * n_columns) * turned(record, step + 8 * block, n_columns);
  value += select((float8)(0.0f), (float8)(record[LC_POSE_RECORD_EXTRA]), extra == 0);
  value += select((float8)(0.0f), (float8)(record[LC_POSE_RECORD_EXTRA + 1]), extra == 1);
  value += select((float8)(0.0f), (float8)(record[LC_POSE_RECORD_EXTRA + 2]), extra == 2);
  vstore8(select(value, (float8)(residuals[row]), columns == layout.n_unknowns), block, J + row * n_columns);
}

// Rows with four bones, written from row `first_row` of J on.
kernel void pose_fill_skinned_rows(PoseLayout layout, int n_rows, int first_row, global const float* restrict step,
                                   global const float* restrict moves, global const float* restrict records,
                                   global const float* restrict residuals, global float* restrict J) {
  const int block = get_global_id(0);
  const int row = get_global_id(1);
  const int n_columns = layout.n_columns;
  if (8 * block >= n_columns || row >= n_rows) return;
  global const float* record = records + row * LC_POSE_RECORD;
  const int bones = as_int(record[LC_POSE_RECORD_BONES]);
  float8 value = 0.0f;
#pragma unroll
  for (int j = 0; j < 4; ++j) {
    const int bone = bones >> (8 * j) & 255;
    value += vload8(block, moves + bone * n_columns) * turned(record + 6 * j, step + 8 * block, n_columns);
  }
  vstore8(select(value, (float8)(residuals[row]), column_ids(block) == layout.n_unknowns), block,
          J + (first_row + row) * n_columns);
}
