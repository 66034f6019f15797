// E_velocity = sum_i w_i || V_i - V_i^{t-1} ||^2      (paper, "Temporal Smoothness"; one w_velocity for all there)
// r in mm. Unknown: V_i.
#include "shared/vec.h"

typedef struct {
  REAL r[3];
  REAL J[3][3];
} VelocityRow;

LC_FN VelocityRow velocity_row(Vec3 v, Vec3 previous) {
  Vec3 d = sub3(v, previous);
  VelocityRow row;
  row.r[0] = d.x;
  row.r[1] = d.y;
  row.r[2] = d.z;
  LC_UNROLL
  for (int i = 0; i < 3; ++i) LC_UNROLL
  for (int j = 0; j < 3; ++j) row.J[i][j] = i == j ? LC_LIT(1.0) : LC_LIT(0.0);
  return row;
}

// x = v; params = previous.
LC_FN void velocity_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  VelocityRow row = velocity_row(vec3(x[0], x[1], x[2]), vec3(params[0], params[1], params[2]));
  for (int i = 0; i < 3; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 3; ++j) J[3 * i + j] = row.J[i][j];
  }
}
