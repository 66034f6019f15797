// Rows of the keypoint terms E_2D, E_3D, E_temporal, of the joint limits E_anatomic, of E_rest and of E_floor.
#include "pose/huber.h"
#include "pose/layout.h"
#include "pose/skinned_gradient.h"
#include "terms/anatomic.cl"
#include "terms/floor.cl"
#include "terms/keypoint_2d.cl"
#include "terms/keypoint_3d.cl"
#include "terms/rest.cl"
#include "terms/temporal.cl"

// One row of a point p (root-relative) fixed to `bone`: gradient g by the point, extra coefficients from
// `extra_column`.
LC_FN void write_point_row(LC_POSE_SPACE float* restrict record, LC_POSE_SPACE float* restrict residual, float r,
                           Vec3 p, Vec3 g, int bone, int extra_column, Vec3 extra) {
  Wrench w = point_wrench(p, g);
  vstore3((float3)(w.torque.x, w.torque.y, w.torque.z), 0, record);
  vstore3((float3)(w.force.x, w.force.y, w.force.z), 1, record);
  record[LC_POSE_RECORD_BONES] = as_float(bone);
  record[LC_POSE_RECORD_EXTRA_COLUMN] = as_float(extra_column);
  vstore3((float3)(extra.x, extra.y, extra.z), 0, record + LC_POSE_RECORD_EXTRA);
  *residual = r;
}

#define LOAD_VEC3(p) vec3((p)[0], (p)[1], (p)[2])

// i < LC_POSE_KEYPOINTS: the 8 rows of keypoint i; from there on a joint angle's limits each, then its rest each, then
// a point of the soles each.
// step, targets, ground: see layout.h. bones [LC_POSE_KEYPOINTS + n_soles], -1 for a keypoint without anchor, which has
// no rows. limits [4*n_dofs] min, max, rest, root of the weight of E_rest. Out: records [LC_POSE_RECORD * rows],
// residuals [rows], from row `first` on.
static inline void point_records(int i, PoseLayout layout, Pinhole cam, float huber_px, int first,
                                 LC_POSE_SPACE const float* restrict step, LC_POSE_SPACE const float* restrict targets,
                                 global const int* restrict bones, global const float* restrict limits,
                                 LC_POSE_SPACE const float* restrict ground, float sqrt_anatomic,
                                 LC_POSE_SPACE float* restrict records, LC_POSE_SPACE float* restrict residuals) {
  const Vec3 zero = vec3(0.0f, 0.0f, 0.0f);

  if (i >= LC_POSE_KEYPOINTS + 2 * layout.n_dofs) {
    const int k = i - LC_POSE_KEYPOINTS - 2 * layout.n_dofs;
    const int row = LC_POSE_POINT_ROWS + 2 * layout.n_dofs + k - first;
    const Vec3 p = LOAD_VEC3(step + LC_POSE_STEP_SOLES(layout) + 3 * k);
    const Vec3 p_camera = add3(p, LOAD_VEC3(step + LC_POSE_STEP_ROOT(layout)));
    FloorRow a = floor_row(p_camera, LOAD_VEC3(ground), ground[3], ground[LC_POSE_GROUND_STANDS + k]);
    const float s = ground[4] * huber_factor(fabs(a.r), ground[5]);
    write_point_row(records + row * LC_POSE_RECORD, residuals + row, s * a.r, p,
                    scale3(vec3(a.J[0], a.J[1], a.J[2]), s), bones[LC_POSE_KEYPOINTS + k], layout.n_unknowns - 3, zero);
    return;
  }
  if (i >= LC_POSE_KEYPOINTS + layout.n_dofs) {
    const int k = i - LC_POSE_KEYPOINTS - layout.n_dofs;
    const int row = LC_POSE_POINT_ROWS + layout.n_dofs + k - first;
    RestRow a = rest_row(step[LC_POSE_STEP_ANGLES(layout) + k], limits[4 * k + 2]);
    const float s = limits[4 * k + 3];
    write_point_row(records + row * LC_POSE_RECORD, residuals + row, s * a.r, zero, zero, 0, 6 + k,
                    vec3(s * a.J, 0.0f, 0.0f));
    return;
  }
  if (i >= LC_POSE_KEYPOINTS) {
    const int k = i - LC_POSE_KEYPOINTS;
    const int row = LC_POSE_POINT_ROWS + k - first;
    AnatomicRow a = anatomic_row(step[LC_POSE_STEP_ANGLES(layout) + k], limits[4 * k], limits[4 * k + 1]);
    write_point_row(records + row * LC_POSE_RECORD, residuals + row, sqrt_anatomic * a.r, zero, zero, 0, 6 + k,
                    vec3(sqrt_anatomic * a.J, 0.0f, 0.0f));
    return;
  }

  const int at = i * LC_POSE_ROWS_PER_KEYPOINT - first;
  const int t_prime_column = layout.n_unknowns - 3;
  LC_POSE_SPACE float* record = records + at * LC_POSE_RECORD;
  LC_POSE_SPACE float* residual = residuals + at;
  LC_POSE_SPACE const float* target = targets + i * LC_POSE_TARGET;
  const int bone = max(bones[i], 0);
  const Vec3 p = LOAD_VEC3(step + LC_POSE_STEP_KEYPOINTS(layout) + 3 * i);
  const Vec3 p_camera = add3(p, LOAD_VEC3(step + LC_POSE_STEP_ROOT(layout)));
  for (int j = 0; j < LC_POSE_ROWS_PER_KEYPOINT; ++j)
    write_point_row(record + j * LC_POSE_RECORD, residual + j, 0.0f, zero, zero, bone, t_prime_column, zero);

  float s = target[5];
  if (s > 0.0f && p_camera.z > LC_MIN_DEPTH_MM) {
    Vec2 px = {target[0], target[1]};
    Keypoint2dRow a = keypoint_2d_row(p_camera, cam, px);
    s *= huber_factor(sqrt(a.r[0] * a.r[0] + a.r[1] * a.r[1]), huber_px);
    for (int j = 0; j < 2; ++j)
      write_point_row(record + (LC_POSE_ROW_2D + j) * LC_POSE_RECORD, residual + LC_POSE_ROW_2D + j, s * a.r[j], p,
                      scale3(vec3(a.J[j][0], a.J[j][1], a.J[j][2]), s), bone, t_prime_column, zero);
  }
  s = target[6];
  if (s > 0.0f) {
    Keypoint3dRow a = keypoint_3d_row(p_camera, LOAD_VEC3(step + LC_POSE_STEP_T_PRIME(layout)), LOAD_VEC3(target + 2));
    for (int j = 0; j < 3; ++j)
      write_point_row(record + (LC_POSE_ROW_3D + j) * LC_POSE_RECORD, residual + LC_POSE_ROW_3D + j, s * a.r[j], p,
                      scale3(vec3(a.J[j][0], a.J[j][1], a.J[j][2]), s), bone, t_prime_column,
                      scale3(vec3(a.J[j][3], a.J[j][4], a.J[j][5]), s));
  }
  s = target[7];
  if (s > 0.0f) {
    TemporalRow a = temporal_row(p_camera, LOAD_VEC3(target + 8));
    for (int j = 0; j < 3; ++j)
      write_point_row(record + (LC_POSE_ROW_TEMPORAL + j) * LC_POSE_RECORD, residual + LC_POSE_ROW_TEMPORAL + j,
                      s * a.r[j], p, scale3(vec3(a.J[j][0], a.J[j][1], a.J[j][2]), s), bone, t_prime_column, zero);
  }
}

#if LC_CPU
// Over the keypoints, joint angles twice and points of the soles.
kernel void pose_point_records(PoseLayout layout, Pinhole cam, float huber_px, float sqrt_anatomic, PoseInputs at,
                               global const float* restrict step, global const float* restrict inputs,
                               global const int* restrict links, global const float* restrict limits,
                               global float* restrict records, global float* restrict residuals) {
  const int i = get_global_id(0);
  if (i >= LC_POSE_KEYPOINTS + 2 * layout.n_dofs + layout.n_soles) return;
  point_records(i, layout, cam, huber_px, 0, step, inputs + at.targets, links + LC_POSE_LINKS_POINTS(layout), limits,
                inputs + at.ground, sqrt_anatomic, records, residuals);
}
#endif
