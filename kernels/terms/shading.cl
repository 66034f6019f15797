// E_shading = lambda_shading sum_i w_i (L . H(n_i) - b_i)^2      (not in the paper; see src/match/skin_shading.h)
// b_i: how bright the picture shows the skin at vertex i by its albedo; n_i its unit normal; H the spherical harmonics
// up to order 2, unnormalised, and L the light in them (Ramamoorthi and Hanrahan 2001). Unknown: the normal n.
#include "shared/vec.h"

#define LC_LIGHT 9

typedef struct {
  REAL of[LC_LIGHT];
} Harmonics;

typedef struct {
  REAL r;
  REAL J[3];
} ShadingRow;

LC_FN Harmonics harmonics(Vec3 n) {
  Harmonics h = {{LC_LIT(1.0), n.x, n.y, n.z, n.x * n.y, n.y * n.z, n.x * n.z, n.x * n.x - n.y * n.y,
                  LC_LIT(3.0) * n.z * n.z - LC_LIT(1.0)}};
  return h;
}

LC_FN ShadingRow shading_row(Vec3 n, Harmonics light, REAL brightness) {
  const Harmonics h = harmonics(n);
  ShadingRow row;
  row.r = -brightness;
  LC_UNROLL
  for (int k = 0; k < LC_LIGHT; ++k) row.r += light.of[k] * h.of[k];
  row.J[0] = light.of[1] + light.of[4] * n.y + light.of[6] * n.z + LC_LIT(2.0) * light.of[7] * n.x;
  row.J[1] = light.of[2] + light.of[4] * n.x + light.of[5] * n.z - LC_LIT(2.0) * light.of[7] * n.y;
  row.J[2] = light.of[3] + light.of[5] * n.y + light.of[6] * n.x + LC_LIT(6.0) * light.of[8] * n.z;
  return row;
}

// x = n; params = light, brightness.
LC_FN void shading_flat(const REAL* x, const REAL* params, REAL* r, REAL* J) {
  Harmonics light;
  for (int k = 0; k < LC_LIGHT; ++k) light.of[k] = params[k];
  const ShadingRow row = shading_row(vec3(x[0], x[1], x[2]), light, params[LC_LIGHT]);
  r[0] = row.r;
  for (int j = 0; j < 3; ++j) J[j] = row.J[j];
}
