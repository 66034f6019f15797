// E_2D = lambda_2D sum_i lambda_i || pi(p_3D,i) - P_2D,i ||^2      (paper, "Sparse 2D and 3D Alignment Constraint")
// r in px. Unknown: the 3D point p (mm), a joint or a face marker.
#include "shared/camera.h"

typedef struct {
  REAL r[2];
  REAL J[2][3];
} Keypoint2dRow;

LC_FN Keypoint2dRow keypoint_2d_row(Vec3 p, Pinhole cam, Vec2 target_px) {
  Projection q = project_point(p, cam);
  Keypoint2dRow row;
  row.r[0] = q.uv.x - target_px.x;
  row.r[1] = q.uv.y - target_px.y;
  LC_UNROLL
  for (int i = 0; i < 2; ++i) LC_UNROLL
  for (int j = 0; j < 3; ++j) row.J[i][j] = q.J[i][j];
  return row;
}

// x = p; params = fx, fy, cx, cy, target u, target v.
LC_FN void keypoint_2d_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  Pinhole cam = {params[0], params[1], params[2], params[3]};
  Vec2 target = {params[4], params[5]};
  Keypoint2dRow row = keypoint_2d_row(vec3(x[0], x[1], x[2]), cam, target);
  for (int i = 0; i < 2; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 3; ++j) J[3 * i + j] = row.J[i][j];
  }
}
