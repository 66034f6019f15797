// E_temporal = lambda_temporal sum_i lambda_i || p_3D,i - p_3D,i^{t-1} ||^2      (paper, "Temporal Stabilization")
// r in mm. Unknown: the 3D point p.
#include "shared/vec.h"

typedef struct {
  REAL r[3];
  REAL J[3][3];
} TemporalRow;

LC_FN TemporalRow temporal_row(Vec3 p, Vec3 previous) {
  Vec3 d = sub3(p, previous);
  TemporalRow row;
  row.r[0] = d.x;
  row.r[1] = d.y;
  row.r[2] = d.z;
  LC_UNROLL
  for (int i = 0; i < 3; ++i) LC_UNROLL
  for (int j = 0; j < 3; ++j) row.J[i][j] = i == j ? LC_LIT(1.0) : LC_LIT(0.0);
  return row;
}

// x = p; params = previous p.
LC_FN void temporal_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  TemporalRow row = temporal_row(vec3(x[0], x[1], x[2]), vec3(params[0], params[1], params[2]));
  for (int i = 0; i < 3; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 3; ++j) J[3 * i + j] = row.J[i][j];
  }
}
