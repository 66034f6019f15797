// Rows of E_silhouette: skins each contour vertex, samples the signed distance image at its projection and sums the
// row's derivative up per bone.
#include "pose/layout.h"
#include "pose/skinned_row.h"
#include "terms/silhouette.cl"

// Bilinear value (x) and its exact derivative by u and v (y, z). uv inside [0, width-1] x [0, height-1].
LC_FN float3 sample_bilinear(global const float* restrict image, int width, int height, Vec2 uv) {
  const int x = min((int)uv.x, width - 2);
  const int y = min((int)uv.y, height - 2);
  const float fx = uv.x - (float)x;
  const float fy = uv.y - (float)y;
  global const float* at = image + (size_t)y * width + x;
  const float a = at[0], b = at[1], c = at[width], d = at[width + 1];
  const float top = a + fx * (b - a);
  const float bottom = c + fx * (d - c);
  return (float3)(top + fy * (bottom - top), (b - a) + fy * ((d - c) - (b - a)), bottom - top);
}

// One work-item per contour vertex. step: layout.h. vertices [contour.n] vertex indices. rest, rest_normals,
// displacement [3*n_vertices] mm, template frame (displacement is read when contour.has_displacement). bones, weights
// [4*n_vertices]. distance [width*height] px, positive outside. records, residuals: the first contour row's.
// Out: distances_px [contour.n] the sampled distance; NaN, and a zero row, for a vertex that is not inside the image.
kernel void pose_contour_records(PoseLayout layout, Pinhole cam, PoseContour contour, global const float* restrict step,
                                 global const int* restrict vertices, global const float* restrict rest,
                                 global const float* restrict rest_normals, global const float* restrict displacement,
                                 global const int* restrict bones, global const float* restrict weights,
                                 global const float* restrict distance, global float* restrict records,
                                 global float* restrict residuals, global float* restrict distances_px) {
  const int i = get_global_id(0);
  if (i >= contour.n) return;
  const int vertex = vertices[i];
  const float3 r = vload3(vertex, rest);
  const float3 n = vload3(vertex, rest_normals);
  Vec3 v_rest = vec3(r.x, r.y, r.z);
  if (contour.has_displacement) {
    const float3 d = vload3(vertex, displacement);
    v_rest = add3(v_rest, vec3(d.x, d.y, d.z));
  }

  const SkinnedVertex skinned = skinned_vertex(vertex, v_rest, step + LC_POSE_STEP_DUAL_QUATS(layout), bones, weights);
  global const float* root = step + LC_POSE_STEP_ROOT(layout);
  const Vec3 v_camera = add3(skinned.position, vec3(root[0], root[1], root[2]));
  const Projection projection = project_point(v_camera, cam);
  const Vec2 uv = projection.uv;
  // False for NaN as well.
  const int inside = v_camera.z > LC_MIN_DEPTH_MM && uv.x >= 0.0f && uv.x <= (float)(contour.width - 1) &&
                     uv.y >= 0.0f && uv.y <= (float)(contour.height - 1);
  global float* record = records + (size_t)i * LC_POSE_RECORD;
  if (!inside) {
    distances_px[i] = nan(0u);
    residuals[i] = 0.0f;
    write_empty_row(record);
    return;
  }

  const float3 sample = sample_bilinear(distance, contour.width, contour.height, uv);
  const Vec2 gradient = {sample.y, sample.z};
  const Vec3 normal = dual_quat_rotate(skinned.blend, vec3(n.x, n.y, n.z));
  const Vec2 normal_px = {projection.J[0][0] * normal.x + projection.J[0][2] * normal.z,
                          projection.J[1][1] * normal.y + projection.J[1][2] * normal.z};
  const SilhouetteRow row =
      silhouette_row(v_camera, cam, sample.x, gradient, silhouette_direction(sample.x, gradient, normal_px));
  const float s = contour.sqrt_weight * huber_factor(fabs(row.r), contour.huber_px);
  distances_px[i] = row.r;
  residuals[i] = s * row.r;

  write_skinned_row(record, &skinned, scale3(vec3(row.J[0], row.J[1], row.J[2]), s));
}
