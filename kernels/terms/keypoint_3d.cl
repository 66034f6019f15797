// E_3D = lambda_3D sum_i || p_3D,i - (P_3D,i + t') ||^2            (paper, "Sparse 2D and 3D Alignment Constraint")
// r in mm. Unknowns: the 3D point p and the auxiliary translation t' of the root-centred detections.
#include "shared/vec.h"

typedef struct {
  REAL r[3];
  REAL J[3][6];  // columns: p, t'
} Keypoint3dRow;

LC_FN Keypoint3dRow keypoint_3d_row(Vec3 p, Vec3 t_prime, Vec3 detection) {
  Vec3 d = sub3(p, add3(detection, t_prime));
  Keypoint3dRow row;
  row.r[0] = d.x;
  row.r[1] = d.y;
  row.r[2] = d.z;
  LC_UNROLL
  for (int i = 0; i < 3; ++i) LC_UNROLL
  for (int j = 0; j < 6; ++j) row.J[i][j] = j == i ? LC_LIT(1.0) : (j == i + 3 ? LC_LIT(-1.0) : LC_LIT(0.0));
  return row;
}

// x = p, t'; params = detection.
LC_FN void keypoint_3d_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  Keypoint3dRow row =
      keypoint_3d_row(vec3(x[0], x[1], x[2]), vec3(x[3], x[4], x[5]), vec3(params[0], params[1], params[2]));
  for (int i = 0; i < 3; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 6; ++j) J[6 * i + j] = row.J[i][j];
  }
}
