// E_depth = w_depth sum_i ( n_i . (V_i - V_i^S) )^2      (not in the paper)
// r in mm. Unknown: V_i. n_i: from the camera to the skinned vertex V_i^S. One camera does not see how far away a
// surface is: what the other terms make of that is an accident.
#include "shared/vec.h"

typedef struct {
  REAL r;
  REAL J[3];
} DepthRow;

LC_FN DepthRow depth_row(Vec3 v, Vec3 skinned) {
  REAL length = norm3(skinned);
  REAL inv = length > LC_LIT(1e-6) ? LC_LIT(1.0) / length : LC_LIT(0.0);
  DepthRow row;
  row.J[0] = skinned.x * inv;
  row.J[1] = skinned.y * inv;
  row.J[2] = skinned.z * inv;
  row.r = dot3(vec3(row.J[0], row.J[1], row.J[2]), sub3(v, skinned));
  return row;
}

// x = v; params = skinned.
LC_FN void depth_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  DepthRow row = depth_row(vec3(x[0], x[1], x[2]), vec3(params[0], params[1], params[2]));
  r[0] = row.r;
  for (int j = 0; j < 3; ++j) J[j] = row.J[j];
}
