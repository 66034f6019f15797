// One kernel body for both kinds of device. Rows are stored in slices of 16 (SELL-16). On a CPU a work-item is a whole
// slice and REAL is float16; on a GPU a work-item is one row and REAL is float. The shared row
// functions of kernels/terms are compiled with that REAL, so the mathematics exists once.
// To be included before anything that uses REAL.
#ifndef LC_SHARED_LANES_H
#define LC_SHARED_LANES_H
#include "shared/dialect.h"

#define SLICE 16
#if LC_CPU
#undef REAL
#define REAL float16
#define LANES 16
typedef int16 LaneInt;
#define LOAD(p, at) vload16(0, (p) + (at))
#define STORE(value, p, at) vstore16((value), 0, (p) + (at))
#define ANY_LANE(condition) any(condition)
#define LANE_IDS (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
static inline float16 gather(global const float* restrict p, int16 i) {
  return (float16)(p[i.s0], p[i.s1], p[i.s2], p[i.s3], p[i.s4], p[i.s5], p[i.s6], p[i.s7], p[i.s8], p[i.s9], p[i.sa],
                   p[i.sb], p[i.sc], p[i.sd], p[i.se], p[i.sf]);
}
#else
#define LANES 1
typedef int LaneInt;
#define LOAD(p, at) ((p)[at])
#define STORE(value, p, at) ((p)[at] = (value))
#define ANY_LANE(condition) (condition)
#define LANE_IDS 0
static inline float gather(global const float* restrict p, int i) {
  return p[i];
}
#endif

// First row of this work-item.
#define FIRST_ROW ((int)get_global_id(0) * LANES)

#endif
