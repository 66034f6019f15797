// E_photo = w_photo sum_{i in visible} || sigma_c( I_Gauss(pi(V_i)) - C_i ) ||^2      (paper, "Dense Photometric
// Alignment") r in colour units ([0,1] per channel). Unknown: the vertex V_i (mm). sigma_c sets residuals longer than a
// threshold to zero.
#include "shared/camera.h"

typedef struct {
  REAL r[3];
  REAL J[3][3];
} PhotoRow;

// color, du, dv: the blurred image and its derivatives (per px) at pi(v).
LC_FN PhotoRow photo_row(Vec3 v, Pinhole cam, Vec3 color, Vec3 du, Vec3 dv, Vec3 template_color, REAL threshold) {
  Projection q = project_point(v, cam);
  Vec3 d = sub3(color, template_color);
  REAL keep = dot3(d, d) > threshold * threshold ? LC_LIT(0.0) : LC_LIT(1.0);
  PhotoRow row;
  row.r[0] = keep * d.x;
  row.r[1] = keep * d.y;
  row.r[2] = keep * d.z;
  LC_UNROLL
  for (int j = 0; j < 3; ++j) {
    row.J[0][j] = keep * (du.x * q.J[0][j] + dv.x * q.J[1][j]);
    row.J[1][j] = keep * (du.y * q.J[0][j] + dv.y * q.J[1][j]);
    row.J[2][j] = keep * (du.z * q.J[0][j] + dv.z * q.J[1][j]);
  }
  return row;
}

// x = v; params = fx, fy, cx, cy, then the image as a plane: colour, du, dv at pixel (u0, v0), template colour,
// threshold.
LC_FN void photo_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  Pinhole cam = {params[0], params[1], params[2], params[3]};
  Vec3 v = vec3(x[0], x[1], x[2]);
  Projection q = project_point(v, cam);
  Vec3 du = vec3(params[7], params[8], params[9]);
  Vec3 dv = vec3(params[10], params[11], params[12]);
  Vec3 color = vec3(params[4], params[5], params[6]);
  color = add3(color, add3(scale3(du, q.uv.x - params[13]), scale3(dv, q.uv.y - params[14])));
  PhotoRow row = photo_row(v, cam, color, du, dv, vec3(params[15], params[16], params[17]), params[18]);
  for (int i = 0; i < 3; ++i) {
    r[i] = row.r[i];
    for (int j = 0; j < 3; ++j) J[3 * i + j] = row.J[i][j];
  }
}
