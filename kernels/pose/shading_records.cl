// Rows of E_shading: one per vertex of skin.
#include "shared/lanes.h"
//
#include "pose/huber.h"
#include "pose/layout.h"
#include "pose/skinned_row.h"
#include "terms/shading.cl"

// The lanes from shaded vertex `first` on; records and residuals have them from `place` on. step: layout.h. vertices
// [n]. targets [LC_POSE_SHADED*n]: light, brightness, root of the weight. rest_normals [3*n_vertices], bones, weights
// [4*n_vertices]. records, residuals: the first shading row's, both with room for whole slices.
static inline void shading_records(int first, int place, PoseLayout layout, int n, float huber,
                                   LC_POSE_SPACE const float* restrict step, global const int* restrict vertices,
                                   global const float* restrict targets, global const float* restrict rest_normals,
                                   global const int* restrict bones, global const float* restrict weights,
                                   LC_POSE_SPACE float* restrict records, LC_POSE_SPACE float* restrict residuals) {
  const LaneInt vertex = lane_vertices(vertices, first, n);
  const LaneInt target = LC_POSE_SHADED * min(first + LANE_IDS, (LaneInt)(n - 1));
  const Vec3 rest = gather_vec3(rest_normals, vertex);
  const SkinnedVertex s = skinned_vertex(vertex, rest, step + LC_POSE_STEP_DUAL_QUATS(layout), bones, weights);
  const Vec3 normal = dual_quat_rotate(s.blend, rest);
  Harmonics light;
#pragma unroll
  for (int k = 0; k < LC_LIGHT; ++k) light.of[k] = gather(targets, target + k);
  const ShadingRow row = shading_row(normal, light, gather(targets, target + LC_LIGHT));
  const REAL scale = gather(targets, target + LC_LIGHT + 1) * huber_factor(fabs(row.r), huber);
  STORE(scale * row.r, residuals, place);
  write_skinned_row(records + place / SLICE * SLICE * LC_POSE_RECORD, place, &s,
                    direction_gradient(s.blend, rest, normal, scale3(vec3(row.J[0], row.J[1], row.J[2]), scale)),
                    scale > 0.0f);
}

#if LC_CPU
// Over slices of the shaded vertices.
kernel void pose_shading_records(PoseLayout layout, int n, float huber, PoseInputs at,
                                 global const float* restrict step, global const float* restrict inputs,
                                 global const float* restrict rest_normals, global const int* restrict bones,
                                 global const float* restrict weights, global float* restrict records,
                                 global float* restrict residuals) {
  if (FIRST_ROW >= n) return;
  shading_records(FIRST_ROW, FIRST_ROW, layout, n, huber, step, (global const int*)(inputs + at.shaded_vertices),
                  inputs + at.shaded_targets, rest_normals, bones, weights, records, residuals);
}
#endif
