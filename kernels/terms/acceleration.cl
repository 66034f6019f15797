// E_acceleration = w_acceleration sum_i || V_i - 2 V_i^{t-1} + V_i^{t-2} ||^2      (paper, "Temporal Smoothness")
// r in mm. Unknown: V_i.
#include "shared/vec.h"

typedef struct {
  REAL r[3];
  REAL J[3][3];
} AccelerationRow;

LC_FN AccelerationRow acceleration_row(Vec3 v, Vec3 previous, Vec3 before_previous) {
  Vec3 d = add3(sub3(v, scale3(previous, LC_LIT(2.0))), before_previous);
  AccelerationRow row;
  row.r[0] = d.x;
  row.r[1] = d.y;
  row.r[2] = d.z;
  LC_UNROLL
  for (int i = 0; i < 3; ++i) LC_UNROLL
  for (int j = 0; j < 3; ++j) row.J[i][j] = i == j ? LC_LIT(1.0) : LC_LIT(0.0);
  return row;
}

// x = v; params = previous, before previous.
LC_FN void acceleration_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  AccelerationRow row = acceleration_row(vec3(x[0], x[1], x[2]), vec3(params[0], params[1], params[2]),
                                         vec3(params[3], params[4], params[5]));
  for (int i = 0; i < 3; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 3; ++j) J[3 * i + j] = row.J[i][j];
  }
}
