// E_rest = lambda_rest sum_i s_i (theta_i - rest_i)^2: joints that hardly turn by themselves.   r in rad. Unknown: one
// joint angle. s_i: how strongly it is drawn to the angle in which the template is bound, 1 as a chest.
#include "shared/dialect.h"

typedef struct {
  REAL r;
  REAL J;
} RestRow;

LC_FN RestRow rest_row(REAL theta, REAL rest) {
  RestRow row;
  row.r = theta - rest;
  row.J = LC_LIT(1.0);
  return row;
}

// x = theta; params = rest.
LC_FN void rest_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  RestRow row = rest_row(x[0], params[0]);
  r[0] = row.r;
  J[0] = row.J;
}
