// E_anatomic = lambda_anatomic sum_i Psi(theta_i), Psi a quadratic barrier outside [min, max]   (paper, "Joint Angle
// Limits") r in rad. Unknown: one joint angle.
#include "shared/dialect.h"

typedef struct {
  REAL r;
  REAL J;
} AnatomicRow;

LC_FN AnatomicRow anatomic_row(REAL theta, REAL theta_min, REAL theta_max) {
  AnatomicRow row;
  row.r = theta > theta_max ? theta - theta_max : (theta < theta_min ? theta - theta_min : LC_LIT(0.0));
  row.J = theta > theta_max || theta < theta_min ? LC_LIT(1.0) : LC_LIT(0.0);
  return row;
}

// x = theta; params = min, max.
LC_FN void anatomic_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  AnatomicRow row = anatomic_row(x[0], params[0], params[1]);
  r[0] = row.r;
  J[0] = row.J;
}
