// The rows of a Gauss-Newton step and their normal equations on GPUs, in two launches: a work-group makes
// LC_POSE_GROUP_ROWS rows of J in local memory and their part of [J | F]^T [J | F]; then the parts are added in order.
#if !LC_CPU
#include "shared/lanes.h"
//
#include "pose/contour_records.cl"
#include "pose/match_records.cl"
#include "pose/point_records.cl"
#include "pose/shading_records.cl"
//
#include "pose/fill_rows.cl"
#include "pose/gram.cl"

#define ROWS LC_POSE_GROUP_ROWS

// Groups over the point rows, then over contour vertices, then over matches (two rows each), then over shaded vertices;
// counts: point rows, matches, shaded vertices, and whether J is written as well. Other arguments: see the functions
// that are called. Out: the records of each kind; residuals: of all rows, then the contour's distances_px; J
// [n_rows*n_columns]; parts [n_groups][n_tiles][8] [8]. rows: ROWS * n_columns floats.
kernel __attribute__((reqd_work_group_size(LC_POSE_GROUP, 1, 1))) void pose_normal_equations(
    PoseLayout layout, float4 camera, int4 counts, PoseContour contour, float keypoint_huber_px, float match_huber_px,
    float shading_huber, float sqrt_anatomic, PoseInputs at, global const float* restrict step,
    global const float* restrict moves, global const float* restrict inputs, global const int* restrict point_bones,
    global const float* restrict limits, global const float* restrict rest, global const float* restrict rest_normals,
    global const float* restrict displacement, global const int* restrict bones, global const float* restrict weights,
    global const float* restrict distance, global float* point, global float* on_contour, global float* matched,
    global float* shaded, global float* residuals, global float* restrict J, global float* restrict parts,
    local float* rows) {
  const int id = get_local_id(0);
  const int n_columns = layout.n_columns;
  const int n_point = counts.x, n_match = counts.y, n_shaded = counts.z, write_rows = counts.w;
  const int n_of[4] = {n_point, contour.n, 2 * n_match, n_shaded};
  int group = get_group_id(0), kind = 0, before = 0;  // rows of the kinds before
  for (; kind < 3 && group >= (n_of[kind] + ROWS - 1) / ROWS; ++kind) {
    group -= (n_of[kind] + ROWS - 1) / ROWS;
    before += n_of[kind];
  }
  const int first = group * ROWS;         // of its kind
  const int n_rows = n_of[kind] - first;  // from `first` on
  global float* of_kind = residuals + before;
  if (kind == 0) {
    const int row = first + id, limit = row - LC_POSE_POINT_ROWS;
    const Pinhole cam = {camera.x, camera.y, camera.z, camera.w};
    if (id < min(ROWS, n_rows) && (limit >= 0 || row % LC_POSE_ROWS_PER_KEYPOINT == 0))
      point_records(limit >= 0 ? LC_POSE_KEYPOINTS + limit : row / LC_POSE_ROWS_PER_KEYPOINT, layout, cam,
                    keypoint_huber_px, step, inputs + at.targets, point_bones, limits, inputs + at.ground,
                    sqrt_anatomic, point, of_kind);
  } else if (kind == 1) {
    if (id < min(ROWS, n_rows))
      contour_records(first + id, layout, camera, contour, step, (global const int*)(inputs + at.contour_vertices),
                      rest, rest_normals, displacement, bones, weights, distance, on_contour, of_kind,
                      residuals + n_point + contour.n + 2 * n_match + n_shaded);
  } else if (kind == 2) {
    if (2 * id < min(ROWS, n_rows))
      match_records(first / 2 + id, layout, camera, n_match, match_huber_px, step,
                    (global const int*)(inputs + at.match_vertices), inputs + at.match_targets, rest, bones, weights,
                    matched, of_kind);
  } else if (id < min(ROWS, n_rows)) {
    shading_records(first + id, layout, n_shaded, shading_huber, step, (global const int*)(inputs + at.shaded_vertices),
                    inputs + at.shaded_targets, rest_normals, bones, weights, shaded, of_kind);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  const int blocks = n_columns / FILL_COLUMNS;
  for (int i = id; i < ROWS * blocks; i += LC_POSE_GROUP) {
    const int row = i / blocks, column = i % blocks * FILL_COLUMNS;
    columns_t value = 0.0f;
    if (row < n_rows) {
      value = kind == 0   ? point_columns(layout, first + row, column, step, moves, point, of_kind)
              : kind == 1 ? skinned_columns(layout, first + row, 1, column, step, moves, on_contour, of_kind)
              : kind == 2 ? skinned_columns(layout, first + row, 2, column, step, moves, matched, of_kind)
                          : skinned_columns(layout, first + row, 1, column, step, moves, shaded, of_kind);
      if (write_rows) vstore8(value, 0, J + (before + first + row) * n_columns + column);
    }
    vstore8(value, 0, rows + row * n_columns + column);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  // Two rows of four entries of a tile at a time.
  const int n_tiles = n_columns / 8 * (n_columns / 8 + 1) / 2;
  parts += get_group_id(0) * n_tiles * 64;
  for (int i = id; i < n_tiles * 8; i += LC_POSE_GROUP) {
    const int2 corner = tile_corner(i / 8, n_columns / 8);
    const int y = i % 8 / 2 * 2, x = i % 2 * 4;
    float4 upper = 0.0f, lower = 0.0f;
    for (int row = 0; row < ROWS; ++row) {
      const float2 left = vload2(0, rows + row * n_columns + corner.x + y);
      const float4 right = vload4(0, rows + row * n_columns + corner.y + x);
      upper += left.x * right;
      lower += left.y * right;
    }
    global float* tile = parts + i / 8 * 64 + y * 8 + x;
    vstore4(upper, 0, tile);
    vstore4(lower, 0, tile + 8);
  }
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
