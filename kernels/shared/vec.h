// 2- and 3-vectors as plain structs.
#ifndef LC_SHARED_VEC_H
#define LC_SHARED_VEC_H
#include "shared/dialect.h"

typedef struct {
  REAL x, y;
} Vec2;

typedef struct {
  REAL x, y, z;
} Vec3;

LC_FN Vec3 vec3(REAL x, REAL y, REAL z) {
  Vec3 v;
  v.x = x;
  v.y = y;
  v.z = z;
  return v;
}
LC_FN Vec3 add3(Vec3 a, Vec3 b) {
  return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}
LC_FN Vec3 sub3(Vec3 a, Vec3 b) {
  return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}
LC_FN Vec3 scale3(Vec3 a, REAL s) {
  return vec3(a.x * s, a.y * s, a.z * s);
}
LC_FN REAL dot3(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
LC_FN Vec3 cross3(Vec3 a, Vec3 b) {
  return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
LC_FN REAL norm3(Vec3 a) {
  return LC_SQRT(dot3(a, a));
}

#endif
