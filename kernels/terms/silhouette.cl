// E_silhouette = w sum_{i in B} b_i [ I_DT(pi(V_i)) ]^2    (paper, "Dense Silhouette Alignment", both stages)
// r in px. Unknown: the vertex V_i (mm). The distance image is stored signed (positive outside the silhouette): its
// square and the product r J are those of the unsigned transform, and it stays smooth where the contour is crossed. b_i
// multiplies the gradient only, so that J^T J stays positive.
#ifndef LC_TERMS_SILHOUETTE_CL
#define LC_TERMS_SILHOUETTE_CL
#include "shared/camera.h"

typedef struct {
  REAL r;
  REAL J[3];
} SilhouetteRow;

// distance, gradient_px: the signed distance image and its gradient at pi(v).
LC_FN SilhouetteRow silhouette_row(Vec3 v, Pinhole cam, REAL distance, Vec2 gradient_px, REAL b) {
  Projection q = project_point(v, cam);
  SilhouetteRow row;
  row.r = distance;
  LC_UNROLL
  for (int j = 0; j < 3; ++j) row.J[j] = b * (gradient_px.x * q.J[0][j] + gradient_px.y * q.J[1][j]);
  return row;
}

// The directional weight b_i. z = -grad I_DT is the direction towards the nearest silhouette contour; inside, the
// signed gradient points there itself. normal_px: the vertex normal projected to the image (any length). Where it
// points the other way, the contour found is another one: inside -1; outside 0 (the paper: 1), since it belongs to
// another part, as a hand's beside a skirt, and would draw the vertex over to it.
LC_FN REAL silhouette_direction(REAL distance, Vec2 gradient_px, Vec2 normal_px) {
  const REAL other = distance > LC_LIT(0.0) ? (REAL)LC_LIT(0.0) : (REAL)LC_LIT(-1.0);
  return normal_px.x * gradient_px.x + normal_px.y * gradient_px.y < LC_LIT(0.0) ? other : (REAL)LC_LIT(1.0);
}

// x = v; params = fx, fy, cx, cy, then the image as a plane: value, du, dv at pixel (u0, v0), and b.
LC_FN void silhouette_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  Pinhole cam = {params[0], params[1], params[2], params[3]};
  Vec3 v = vec3(x[0], x[1], x[2]);
  Projection q = project_point(v, cam);
  REAL distance = params[4] + params[5] * (q.uv.x - params[7]) + params[6] * (q.uv.y - params[8]);
  Vec2 gradient = {params[5], params[6]};
  SilhouetteRow row = silhouette_row(v, cam, distance, gradient, params[9]);
  r[0] = row.r;
  for (int j = 0; j < 3; ++j) J[j] = row.J[j];
}

#endif
