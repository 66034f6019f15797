// One kernel body for both kinds of device. Rows are stored in slices of 16 (SELL-16). On a CPU a work-item is a whole
// slice and REAL is float16, or half a slice and float8 where the processor has 16 registers of eight floats; on a GPU
// a work-item is one row and REAL is float. The shared row functions of kernels/terms are compiled with that REAL, so
// the mathematics exists once. LC_VECTOR comes from the host (src/ocl/device.h). To be included before anything that
// uses REAL.
#ifndef LC_SHARED_LANES_H
#define LC_SHARED_LANES_H
#include "shared/bits.h"
#include "shared/dialect.h"
#include "shared/gather.h"
#include "shared/wide.h"

#define SLICE 16
#define LANES LC_VECTOR
#if LANES == 16
#undef REAL
#define REAL float16
typedef int16 LaneInt;
#define LANE_INT convert_int16
#define LANE_REAL convert_float16
#define LANE_BITS_AS_REAL as_float16
#define REAL_BITS_AS_INT as_int16
#define LOAD(p, at) vload16(0, (p) + (at))
#define STORE(value, p, at) store16((value), (p) + (at))
#define STORE_LANES(value, p) vstore16((value), 0, (p))
#define LOAD_LANES(p) vload16(0, (p))
#define ANY_LANE(condition) any_of_16(condition)
#define LANE_IDS (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#define gather gather16
#define gather_int gather_int16
#define scatter scatter16
#define store_lanes store_int16
#define lane_bits bits_of_16
#elif LANES == 8
#undef REAL
#define REAL float8
typedef int8 LaneInt;
#define LANE_INT convert_int8
#define LANE_REAL convert_float8
#define LANE_BITS_AS_REAL as_float8
#define REAL_BITS_AS_INT as_int8
#define LOAD(p, at) vload8(0, (p) + (at))
#define STORE(value, p, at) vstore8((value), 0, (p) + (at))
#define STORE_LANES(value, p) vstore8((value), 0, (p))
#define LOAD_LANES(p) vload8(0, (p))
#define ANY_LANE(condition) any_of_8(condition)
#define LANE_IDS (int8)(0, 1, 2, 3, 4, 5, 6, 7)
#define gather gather8
#define gather_int gather_int8
#define scatter scatter8
#define store_lanes store_int8
#define lane_bits bits_of_8
#else
typedef int LaneInt;
#define LANE_INT convert_int
#define LANE_REAL convert_float
#define LANE_BITS_AS_REAL as_float
#define LOAD(p, at) ((p)[at])
#define STORE(value, p, at) ((p)[at] = (value))
#define ANY_LANE(condition) (condition)
#define LANE_IDS 0
#define gather(p, i) ((p)[i])
#define gather_int(p, i) ((p)[i])
static inline uint lane_bits(int condition) {
  return condition != 0;
}
#endif

// First row of this work-item.
#define FIRST_ROW ((int)get_global_id(0) * LANES)

#include "shared/vec.h"

// Arrays that end with row n - 1, unlike planes: lanes beyond repeat the last row.
static inline LaneInt lane_rows(int first, int n) {
  return min(first + LANE_IDS, (LaneInt)(n - 1));
}

static inline Vec3 gather_vec3(global const float* restrict p, LaneInt i) {
#if LANES == 16
  const SixteenRows rows = gather_short_rows16(p, 3 * i);
  return vec3(rows.x, rows.y, rows.z);
#elif LANES == 8
  const EightRows rows = gather_short_rows8(p, 3 * i);
  return vec3(rows.x, rows.y, rows.z);
#else
  return vec3(gather(p, 3 * i), gather(p, 3 * i + 1), gather(p, 3 * i + 2));
#endif
}

typedef struct {
  REAL x, y, z, w;
} Vec4;

// Four values from p[i] on.
static inline Vec4 gather_vec4(global const float* restrict p, LaneInt i) {
#if LANES == 16
  const SixteenRows rows = gather_rows16(p, i);
  const Vec4 values = {rows.x, rows.y, rows.z, rows.w};
#elif LANES == 8
  const EightRows rows = gather_rows8(p, i);
  const Vec4 values = {rows.x, rows.y, rows.z, rows.w};
#else
  const Vec4 values = {gather(p, i), gather(p, i + 1), gather(p, i + 2), gather(p, i + 3)};
#endif
  return values;
}

typedef struct {
  LaneInt x, y, z;
} IntVec3;

// Row t of [3n].
static inline IntVec3 gather_int_vec3(global const int* restrict p, LaneInt t) {
#if LANES == 1
  const IntVec3 values = {p[3 * t], p[3 * t + 1], p[3 * t + 2]};
#else
  const Vec3 bits = gather_vec3((global const float*)p, t);
  const IntVec3 values = {REAL_BITS_AS_INT(bits.x), REAL_BITS_AS_INT(bits.y), REAL_BITS_AS_INT(bits.z)};
#endif
  return values;
}

typedef struct {
  LaneInt x, y, z, w;
} IntVec4;

// From p[i] on.
static inline IntVec4 gather_int_vec4(global const int* restrict p, LaneInt i) {
#if LANES == 1
  const IntVec4 values = {p[i], p[i + 1], p[i + 2], p[i + 3]};
#else
  const Vec4 bits = gather_vec4((global const float*)p, i);
  const IntVec4 values = {REAL_BITS_AS_INT(bits.x), REAL_BITS_AS_INT(bits.y), REAL_BITS_AS_INT(bits.z),
                          REAL_BITS_AS_INT(bits.w)};
#endif
  return values;
}

// Rows first .. n - 1 of [3n].
static inline void store_vec3(Vec3 value, global float* restrict p, int first, int n) {
#if LANES == 16
  if (first + LANES <= n) {
    const float16 x = value.x, y = value.y, z = value.z;
    p += 3 * first;
    store16((float16)(x.s0, y.s0, z.s0, x.s1, y.s1, z.s1, x.s2, y.s2, z.s2, x.s3, y.s3, z.s3, x.s4, y.s4, z.s4, x.s5),
            p);
    store16((float16)(y.s5, z.s5, x.s6, y.s6, z.s6, x.s7, y.s7, z.s7, x.s8, y.s8, z.s8, x.s9, y.s9, z.s9, x.sa, y.sa),
            p + 16);
    store16((float16)(z.sa, x.sb, y.sb, z.sb, x.sc, y.sc, z.sc, x.sd, y.sd, z.sd, x.se, y.se, z.se, x.sf, y.sf, z.sf),
            p + 32);
    return;
  }
#elif LANES == 8
  if (first + LANES <= n) {
    const float8 x = value.x, y = value.y, z = value.z;
    p += 3 * first;
    store8((float8)(x.s0, y.s0, z.s0, x.s1, y.s1, z.s1, x.s2, y.s2), p);
    store8((float8)(z.s2, x.s3, y.s3, z.s3, x.s4, y.s4, z.s4, x.s5), p + 8);
    store8((float8)(y.s5, z.s5, x.s6, y.s6, z.s6, x.s7, y.s7, z.s7), p + 16);
    return;
  }
#endif
#if LC_CPU
  const LaneInt at = 3 * (first + LANE_IDS);
  scatter(value.x, p, at, n - first);
  scatter(value.y, p, at + 1, n - first);
  scatter(value.z, p, at + 2, n - first);
#else
  (void)n;
  vstore3((float3)(value.x, value.y, value.z), first, p);
#endif
}

// Rows first .. n - 1 of [4n].
static inline void store_vec4(REAL x, REAL y, REAL z, REAL w, global float* restrict p, int first, int n) {
#if LANES == 16
  if (first + LANES <= n) {
    const SixteenRows rows = turned_rows_16(x, y, z, w);
    p += 4 * first;
    store16((float16)(rows.x.s0123, rows.y.s0123, rows.z.s0123, rows.w.s0123), p);
    store16((float16)(rows.x.s4567, rows.y.s4567, rows.z.s4567, rows.w.s4567), p + 16);
    store16((float16)(rows.x.s89ab, rows.y.s89ab, rows.z.s89ab, rows.w.s89ab), p + 32);
    store16((float16)(rows.x.scdef, rows.y.scdef, rows.z.scdef, rows.w.scdef), p + 48);
    return;
  }
#elif LANES == 8
  if (first + LANES <= n) {
    const float8 xy = LC_LOWER(x, y), zw = LC_LOWER(z, w), xy2 = LC_UPPER(x, y), zw2 = LC_UPPER(z, w);
    p += 4 * first;
    store8((float8)(xy.s01, zw.s01, xy.s23, zw.s23), p);
    store8((float8)(xy2.s01, zw2.s01, xy2.s23, zw2.s23), p + 8);
    store8((float8)(xy.s45, zw.s45, xy.s67, zw.s67), p + 16);
    store8((float8)(xy2.s45, zw2.s45, xy2.s67, zw2.s67), p + 24);
    return;
  }
#endif
#if LC_CPU
  const LaneInt at = 4 * (first + LANE_IDS);
  scatter(x, p, at, n - first);
  scatter(y, p, at + 1, n - first);
  scatter(z, p, at + 2, n - first);
  scatter(w, p, at + 3, n - first);
#else
  (void)n;
  vstore4((float4)(x, y, z, w), first, p);
#endif
}

// Rows first .. n - 1 of [n].
static inline void store_rows(LaneInt value, global int* restrict p, int first, int n) {
#if LC_CPU
  if (first + LANES <= n) {
    store_lanes(value, p + first);
  } else {
    for (int k = 0; first + k < n; ++k) p[first + k] = value[k];
  }
#else
  (void)n;
  p[first] = value;
#endif
}

#endif
