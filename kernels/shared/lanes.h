// One kernel body for both kinds of device. Rows are stored in slices of 16 (SELL-16). On a CPU a work-item is a whole
// slice and REAL is float16; on a GPU a work-item is one row and REAL is float. The shared row
// functions of kernels/terms are compiled with that REAL, so the mathematics exists once.
// To be included before anything that uses REAL.
#ifndef LC_SHARED_LANES_H
#define LC_SHARED_LANES_H
#include "shared/dialect.h"
#include "shared/gather.h"
#include "shared/wide.h"

#define SLICE 16
#if LC_CPU
#undef REAL
#define REAL float16
#define LANES 16
typedef int16 LaneInt;
#define LANE_INT convert_int16
#define LANE_REAL convert_float16
#define LOAD(p, at) vload16(0, (p) + (at))
#define STORE(value, p, at) vstore16((value), 0, (p) + (at))
#define ANY_LANE(condition) any(condition)
#define LANE_IDS (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#define gather gather16
#define gather_int gather_int16
#else
#define LANES 1
typedef int LaneInt;
#define LANE_INT convert_int
#define LANE_REAL convert_float
#define LOAD(p, at) ((p)[at])
#define STORE(value, p, at) ((p)[at] = (value))
#define ANY_LANE(condition) (condition)
#define LANE_IDS 0
static inline float gather(global const float* restrict p, int i) {
  return p[i];
}
static inline int gather_int(global const int* restrict p, int i) {
  return p[i];
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
  return vec3(gather(p, 3 * i), gather(p, 3 * i + 1), gather(p, 3 * i + 2));
}

// Rows first .. n - 1 of [3n].
static inline void store_vec3(Vec3 value, global float* restrict p, int first, int n) {
#if LC_CPU
  const int16 at = 3 * (first + LANE_IDS);
  scatter16(value.x, p, at, n - first);
  scatter16(value.y, p, at + 1, n - first);
  scatter16(value.z, p, at + 2, n - first);
#else
  (void)n;
  vstore3((float3)(value.x, value.y, value.z), first, p);
#endif
}

// Rows first .. n - 1 of [4n].
static inline void store_vec4(REAL x, REAL y, REAL z, REAL w, global float* restrict p, int first, int n) {
#if LC_CPU
  const int16 at = 4 * (first + LANE_IDS);
  scatter16(x, p, at, n - first);
  scatter16(y, p, at + 1, n - first);
  scatter16(z, p, at + 2, n - first);
  scatter16(w, p, at + 3, n - first);
#else
  (void)n;
  vstore4((float4)(x, y, z, w), first, p);
#endif
}

// Rows first .. n - 1 of [n].
static inline void store_rows(LaneInt value, global int* restrict p, int first, int n) {
#if LC_CPU
  if (first + LANES <= n) {
    store_int16(value, p + first);
  } else {
    for (int k = 0; first + k < n; ++k) p[first + k] = value[k];
  }
#else
  (void)n;
  p[first] = value;
#endif
}

// A bit for each lane whose condition holds (-1 on a CPU).
static inline uint lane_bits(LaneInt condition) {
#if LC_CPU
  const int16 bits = condition & (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
  const int8 eight = bits.lo | bits.hi;
  const int4 four = eight.lo | eight.hi;
  return (uint)(four.x | four.y | four.z | four.w);
#else
  return condition != 0;
#endif
}

// The lowest of some bits, not none.
static inline int lowest_bit(uint bits) {
  return 31 - clz(bits & -bits);
}

#endif
