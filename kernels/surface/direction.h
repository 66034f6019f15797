// The direction p of conjugate gradients (shared/lanes.h comes first): 3 planes, `stride` apart. On CPUs it follows
// once more in rows of four, the last one 0: a neighbour's row is one load there, its planes are three.
#ifndef LC_SURFACE_DIRECTION_H
#define LC_SURFACE_DIRECTION_H

static inline void store_direction(Vec3 value, global float* p, int row, int stride) {
  STORE(value.x, p, row);
  STORE(value.y, p, row + stride);
  STORE(value.z, p, row + 2 * stride);
#if LC_CPU
  const REAL zero = 0.0f;
  store_vec4(value.x, value.y, value.z, zero, p + 3 * stride, row, row + LANES);
#endif
}

#if LC_CPU
// Of the rows that a list names.
static inline Vec3 gather_direction(global const float* p, global const int* rows, int stride) {
#if LANES == 16
  const SixteenRows found = gather_listed16(p + 3 * stride, rows);
#else
  const Vec4 found = gather_vec4(p + 3 * stride, 4 * LOAD(rows, 0));
#endif
  return vec3(found.x, found.y, found.z);
}
#endif

#endif
