// One vertex's share of the normal equations: the symmetric 3x3 block of J^T J and -J^T F.
#ifndef LC_SURFACE_SYSTEM_H
#define LC_SURFACE_SYSTEM_H
#include "shared/camera.h"

typedef struct {
  REAL xx, xy, xz, yy, yz, zz;
  Vec3 rhs;
} VertexSystem;

LC_FN VertexSystem empty_system(void) {
  VertexSystem s;
  s.xx = s.xy = s.xz = s.yy = s.yz = s.zz = LC_LIT(0.0);
  s.rhs = vec3(LC_LIT(0.0), LC_LIT(0.0), LC_LIT(0.0));
  return s;
}

// Adds weight * (J^T J, -J^T r) of a row with one residual.
LC_FN VertexSystem add_row(VertexSystem s, REAL weight, REAL r, Vec3 J) {
  Vec3 g = scale3(J, weight);
  s.xx += g.x * J.x;
  s.xy += g.x * J.y;
  s.xz += g.x * J.z;
  s.yy += g.y * J.y;
  s.yz += g.y * J.z;
  s.zz += g.z * J.z;
  s.rhs = sub3(s.rhs, scale3(g, r));
  return s;
}

#endif
