// E_smooth = w_smooth sum_i sum_{j in N_i} s_ij / |N_i| || (V_i - V_j) - (V^S_i - V^S_j) ||^2      (paper, "Spatial
// Smoothness") r in mm. Unknowns: V_i, V_j. V^S is the skinned mesh of stage I.
#include "shared/vec.h"

typedef struct {
  REAL r[3];
  REAL J[3][6];  // columns: v_i, v_j
} SmoothRow;

LC_FN SmoothRow smooth_row(Vec3 v_i, Vec3 v_j, Vec3 skinned_i, Vec3 skinned_j) {
  Vec3 d = sub3(sub3(v_i, v_j), sub3(skinned_i, skinned_j));
  SmoothRow row;
  row.r[0] = d.x;
  row.r[1] = d.y;
  row.r[2] = d.z;
  LC_UNROLL
  for (int i = 0; i < 3; ++i) LC_UNROLL
  for (int j = 0; j < 6; ++j) row.J[i][j] = j == i ? LC_LIT(1.0) : (j == i + 3 ? LC_LIT(-1.0) : LC_LIT(0.0));
  return row;
}

// x = v_i, v_j; params = skinned_i, skinned_j.
LC_FN void smooth_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  SmoothRow row = smooth_row(vec3(x[0], x[1], x[2]), vec3(x[3], x[4], x[5]), vec3(params[0], params[1], params[2]),
                             vec3(params[3], params[4], params[5]));
  for (int i = 0; i < 3; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 6; ++j) J[6 * i + j] = row.J[i][j];
  }
}
