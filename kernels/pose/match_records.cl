// Rows of E_match: two per matched vertex.
#include "pose/layout.h"
#include "pose/skinned_row.h"
#include "terms/match.cl"

// One work-item per match. step: layout.h. vertices [n]. targets [5*n] u, v (px), root a, b, c of the distance's
// weight. rest [3*n_vertices] mm, bones, weights [4*n_vertices]. records, residuals: the first match row's.
kernel void pose_match_records(PoseLayout layout, Pinhole cam, int n, float huber_px, global const float* restrict step,
                               global const int* restrict vertices, global const float* restrict targets,
                               global const float* restrict rest, global const int* restrict bones,
                               global const float* restrict weights, global float* restrict records,
                               global float* restrict residuals) {
  const int i = get_global_id(0);
  if (i >= n) return;
  const int vertex = vertices[i];
  global const float* target = targets + 5 * i;
  const float3 r = vload3(vertex, rest);
  const SkinnedVertex s =
      skinned_vertex(vertex, vec3(r.x, r.y, r.z), step + LC_POSE_STEP_DUAL_QUATS(layout), bones, weights);
  global const float* root = step + LC_POSE_STEP_ROOT(layout);
  const Vec3 v_camera = add3(s.position, vec3(root[0], root[1], root[2]));
  global float* record = records + (size_t)(2 * i) * LC_POSE_RECORD;
  if (!(v_camera.z > LC_MIN_DEPTH_MM)) {
    for (int j = 0; j < 2; ++j) {
      write_empty_row(record + j * LC_POSE_RECORD);
      residuals[2 * i + j] = 0.0f;
    }
    return;
  }
  const Vec2 target_px = {target[0], target[1]};
  const MatchRow row = match_row(v_camera, cam, target_px, target[2], target[3], target[4]);
  const float huber = huber_factor(row.distance, huber_px);
  for (int j = 0; j < 2; ++j) {
    residuals[2 * i + j] = huber * row.r[j];
    write_skinned_row(record + j * LC_POSE_RECORD, &s, scale3(vec3(row.J[j][0], row.J[j][1], row.J[j][2]), huber));
  }
}
