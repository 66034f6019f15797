// Rows of E_match: two per matched vertex.
#include "shared/lanes.h"
//
#include "pose/huber.h"
#include "pose/layout.h"
#include "pose/skinned_row.h"
#include "terms/match.cl"

// The lanes from match `first` on; records and residuals have them from `place` on. camera: fx, fy, cx, cy. step:
// layout.h. vertices [n]. targets [LC_POSE_MATCH*n]. rest [3*n_vertices] mm, bones, weights [4*n_vertices]. records,
// residuals (pairs): the first match row's, both with room for whole slices.
static inline void match_records(int first, int place, PoseLayout layout, float4 camera, int n, float huber_px,
                                 LC_POSE_SPACE const float* restrict step, global const int* restrict vertices,
                                 global const float* restrict targets, global const float* restrict rest,
                                 global const int* restrict bones, global const float* restrict weights,
                                 LC_POSE_SPACE float* restrict records, LC_POSE_SPACE float* restrict residuals) {
  const Pinhole cam = {camera.x, camera.y, camera.z, camera.w};
  const LaneInt vertex = lane_vertices(vertices, first, n);
  const LaneInt target = LC_POSE_MATCH * min(first + LANE_IDS, (LaneInt)(n - 1));
  const SkinnedVertex s =
      skinned_vertex(vertex, gather_vec3(rest, vertex), step + LC_POSE_STEP_DUAL_QUATS(layout), bones, weights);
  LC_POSE_SPACE const float* root = step + LC_POSE_STEP_ROOT(layout);
  const Vec3 v_camera = add3(s.position, vec3(root[0], root[1], root[2]));
  const LaneInt before = v_camera.z > LC_MIN_DEPTH_MM;
  const Vec2 target_px = {gather(targets, target), gather(targets, target + 1)};
  const MatchRow row = match_row(v_camera, cam, target_px, gather(targets, target + 2), gather(targets, target + 3),
                                 gather(targets, target + 4));
  const REAL huber = huber_factor(row.distance, huber_px);
  LC_UNROLL
  for (int j = 0; j < 2; ++j) {
    const REAL residual = before ? huber * row.r[j] : (REAL)0.0f;
#if LC_CPU
    float lanes[LANES];
    STORE_LANES(residual, lanes);
    for (int k = 0; k < LANES; ++k) residuals[2 * (place + k) + j] = lanes[k];
#else
    residuals[2 * place + j] = residual;
#endif
    write_skinned_row(records + (2 * (place / SLICE) + j) * SLICE * LC_POSE_RECORD, place, &s,
                      point_gradient(&s, scale3(vec3(row.J[j][0], row.J[j][1], row.J[j][2]), huber)), before);
  }
}

#if LC_CPU
// Over slices of the matches.
kernel void pose_match_records(PoseLayout layout, float4 camera, int n, float huber_px, PoseInputs at,
                               global const float* restrict step, global const float* restrict inputs,
                               global const float* restrict rest, global const int* restrict bones,
                               global const float* restrict weights, global float* restrict records,
                               global float* restrict residuals) {
  if (FIRST_ROW >= n) return;
  match_records(FIRST_ROW, FIRST_ROW, layout, camera, n, huber_px, step,
                (global const int*)(inputs + at.match_vertices), inputs + at.match_targets, rest, bones, weights,
                records, residuals);
}
#endif
