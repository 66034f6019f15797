// E_match = lambda_match sum_i w_i || R_i (pi(V_i) - u_i) ||^2      (not in the paper; see src/match/texture_matcher.h)
// u_i is where the picture shows vertex i, R_i = [a b; 0 c] the root of the weight of a distance from there: matches
// are certain along some directions and not along others. w_i: in stage I what is seen of the vertex, times how far the
// correlation of the patches is above the least; in stage II the correlation. r in px. Unknown: the vertex V (mm).
#include "shared/camera.h"

typedef struct {
  REAL r[2];
  REAL J[2][3];
  REAL distance;  // || pi(V) - u ||, px
} MatchRow;

LC_FN MatchRow match_row(Vec3 v, Pinhole cam, Vec2 target_px, REAL a, REAL b, REAL c) {
  Projection q = project_point(v, cam);
  REAL du = q.uv.x - target_px.x;
  REAL dv = q.uv.y - target_px.y;
  MatchRow row;
  row.r[0] = a * du + b * dv;
  row.r[1] = c * dv;
  LC_UNROLL
  for (int j = 0; j < 3; ++j) {
    row.J[0][j] = a * q.J[0][j] + b * q.J[1][j];
    row.J[1][j] = c * q.J[1][j];
  }
  row.distance = LC_SQRT(du * du + dv * dv);
  return row;
}

// x = V; params = fx, fy, cx, cy, u, v, a, b, c.
LC_FN void match_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  Pinhole cam = {params[0], params[1], params[2], params[3]};
  Vec2 target = {params[4], params[5]};
  MatchRow row = match_row(vec3(x[0], x[1], x[2]), cam, target, params[6], params[7], params[8]);
  for (int i = 0; i < 2; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 3; ++j) J[3 * i + j] = row.J[i][j];
  }
}
