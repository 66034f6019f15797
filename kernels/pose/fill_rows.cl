// Spreads row records over the columns: J[row][column] = sum over bones that the column's joint moves of
// axis . torque + moment . force. Launch (n_columns, n_rows).
#include "pose/layout.h"

// Wrench j of the record, turned about column `c`.
inline float turned(global const float* restrict record, int j, global const float* restrict step, int n_columns,
                    int c) {
  global const float* w = record + 6 * j;
  return step[c] * w[0] + step[n_columns + c] * w[1] + step[2 * n_columns + c] * w[2] + step[3 * n_columns + c] * w[3] +
         step[4 * n_columns + c] * w[4] + step[5 * n_columns + c] * w[5];
}

// Rows with one bone and extra coefficients. moves [n_bones*n_columns]: 1 where the column moves the bone, else 0.
// records [LC_POSE_RECORD*n_rows], residuals [n_rows]. Out: J [n_rows*n_columns].
kernel void pose_fill_point_rows(PoseLayout layout, int n_rows, global const float* restrict step,
                                 global const float* restrict moves, global const float* restrict records,
                                 global const float* restrict residuals, global float* restrict J) {
  const int c = get_global_id(0);
  const int row = get_global_id(1);
  if (c >= layout.n_columns || row >= n_rows) return;
  global const float* record = records + row * LC_POSE_RECORD;
  const int bone = as_int(record[LC_POSE_RECORD_BONES]);
  const int extra = c - as_int(record[LC_POSE_RECORD_EXTRA_COLUMN]);
  float value = moves[bone * layout.n_columns + c] * turned(record, 0, step, layout.n_columns, c);
  value += extra == 0 ? record[LC_POSE_RECORD_EXTRA] : 0.0f;
  value += extra == 1 ? record[LC_POSE_RECORD_EXTRA + 1] : 0.0f;
  value += extra == 2 ? record[LC_POSE_RECORD_EXTRA + 2] : 0.0f;
  J[row * layout.n_columns + c] = c == layout.n_unknowns ? residuals[row] : value;
}

// Rows with four bones, written from row `first_row` of J on.
kernel void pose_fill_contour_rows(PoseLayout layout, int n_rows, int first_row, global const float* restrict step,
                                   global const float* restrict moves, global const float* restrict records,
                                   global const float* restrict residuals, global float* restrict J) {
  const int c = get_global_id(0);
  const int row = get_global_id(1);
  if (c >= layout.n_columns || row >= n_rows) return;
  global const float* record = records + row * LC_POSE_RECORD;
  const int bones = as_int(record[LC_POSE_RECORD_BONES]);
  float value = 0.0f;
#pragma unroll
  for (int j = 0; j < 4; ++j) {
    const int bone = bones >> (8 * j) & 255;
    value += moves[bone * layout.n_columns + c] * turned(record, j, step, layout.n_columns, c);
  }
  J[(first_row + row) * layout.n_columns + c] = c == layout.n_unknowns ? residuals[row] : value;
}
