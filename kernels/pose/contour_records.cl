// Rows of E_silhouette: skins each contour vertex, samples the signed distance image at its projection and sums the
// row's derivative up per bone.
#include "shared/lanes.h"
//
#include "pose/huber.h"
#include "pose/layout.h"
#include "pose/skinned_row.h"
#include "shared/distance_sample.h"
#include "terms/silhouette.cl"

// uv inside [0, width-1] x [0, height-1]; anything elsewhere.
LC_FN DistanceSample sample_lanes(global const float* restrict distance, int width, int height, Vec2 uv) {
  const LaneInt x = clamp(LANE_INT(uv.x), (LaneInt)0, (LaneInt)(width - 2));
  const LaneInt y = clamp(LANE_INT(uv.y), (LaneInt)0, (LaneInt)(height - 2));
  const LaneInt at = y * width + x;
  return distance_sample(gather(distance, at), gather(distance, at + 1), gather(distance, at + width),
                         gather(distance, at + width + 1), uv.x - LANE_REAL(x), uv.y - LANE_REAL(y));
}

// The lanes from contour vertex `first` on; records and residuals have them from `place` on. camera: fx, fy, cx, cy.
// step: layout.h. vertices [contour.n] vertex indices. rest, rest_normals [3*n_vertices] mm, template frame. bones,
// weights [4*n_vertices]. distance [width*height] px, positive outside. records, residuals: the first contour row's.
// Out: a zero row for a vertex that is not inside the image. What is written has room for whole slices.
static inline void contour_records(int first, int place, PoseLayout layout, float4 camera, PoseContour contour,
                                   LC_POSE_SPACE const float* restrict step, global const int* restrict vertices,
                                   global const float* restrict rest, global const float* restrict rest_normals,
                                   global const int* restrict bones, global const float* restrict weights,
                                   global const float* restrict distance, LC_POSE_SPACE float* restrict records,
                                   LC_POSE_SPACE float* restrict residuals) {
  const Pinhole cam = {camera.x, camera.y, camera.z, camera.w};
  const LaneInt vertex = lane_vertices(vertices, first, contour.n);
  const SkinnedVertex skinned =
      skinned_vertex(vertex, gather_vec3(rest, vertex), step + LC_POSE_STEP_DUAL_QUATS(layout), bones, weights);
  LC_POSE_SPACE const float* root = step + LC_POSE_STEP_ROOT(layout);
  const Vec3 v_camera = add3(skinned.position, vec3(root[0], root[1], root[2]));
  const Projection projection = project_point(v_camera, cam);
  const Vec2 uv = projection.uv;
  // False for NaN as well.
  const LaneInt inside = (v_camera.z > LC_MIN_DEPTH_MM) & (uv.x >= 0.0f) & (uv.x <= (float)(contour.width - 1)) &
                         (uv.y >= 0.0f) & (uv.y <= (float)(contour.height - 1));

  const DistanceSample sample = sample_lanes(distance, contour.width, contour.height, uv);
  const Vec3 normal = dual_quat_rotate(skinned.blend, gather_vec3(rest_normals, vertex));
  const Vec2 normal_px = {projection.J[0][0] * normal.x + projection.J[0][2] * normal.z,
                          projection.J[1][1] * normal.y + projection.J[1][2] * normal.z};
  const SilhouetteRow row = silhouette_row(v_camera, cam, sample.value, sample.gradient,
                                           silhouette_direction(sample.value, sample.gradient, normal_px));
  const REAL s = contour.sqrt_weight * huber_factor(fabs(row.r), contour.huber_px);
  STORE(inside ? s * row.r : (REAL)0.0f, residuals, place);
  write_skinned_row(records + place / SLICE * SLICE * LC_POSE_RECORD, place, &skinned,
                    point_gradient(&skinned, scale3(vec3(row.J[0], row.J[1], row.J[2]), s)), inside);
}

#if LC_CPU
// Over slices of the contour vertices.
kernel void pose_contour_records(PoseLayout layout, float4 camera, PoseContour contour, PoseInputs at,
                                 global const float* restrict step, global const float* restrict inputs,
                                 global const float* restrict rest, global const float* restrict rest_normals,
                                 global const int* restrict bones, global const float* restrict weights,
                                 global const float* restrict distance, global float* restrict records,
                                 global float* restrict residuals) {
  if (FIRST_ROW >= contour.n) return;
  contour_records(FIRST_ROW, FIRST_ROW, layout, camera, contour, step,
                  (global const int*)(inputs + at.contour_vertices), rest, rest_normals, bones, weights, distance,
                  records, residuals);
}
#endif
