// E_edge = w_edge sum_i sum_{j in N_i} s_ij / |N_i| ( |V_i - V_j| - |Vhat_i - Vhat_j| )^2      (paper, "Spatial
// Smoothness") r in mm. Unknowns: V_i, V_j. Vhat is the template's rest pose.
#include "shared/vec.h"

typedef struct {
  REAL r;
  REAL J[2][3];  // d r / d v_i, d r / d v_j
} EdgeRow;

LC_FN EdgeRow edge_row(Vec3 v_i, Vec3 v_j, REAL rest_length) {
  Vec3 d = sub3(v_i, v_j);
  REAL length = norm3(d);
  REAL inv = length > LC_LIT(1e-6) ? LC_LIT(1.0) / length : LC_LIT(0.0);
  EdgeRow row;
  row.r = length - rest_length;
  row.J[0][0] = d.x * inv;
  row.J[0][1] = d.y * inv;
  row.J[0][2] = d.z * inv;
  LC_UNROLL
  for (int j = 0; j < 3; ++j) row.J[1][j] = -row.J[0][j];
  return row;
}

// x = v_i, v_j; params = rest length.
LC_FN void edge_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  EdgeRow row = edge_row(vec3(x[0], x[1], x[2]), vec3(x[3], x[4], x[5]), params[0]);
  r[0] = row.r;
  for (int j = 0; j < 6; ++j) J[j] = row.J[j / 3][j % 3];
}
