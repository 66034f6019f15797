// Patches of patch_match.cl on CPUs: a row of two of them in one vector of sixteen, TOGETHER of them at a time.
#ifndef LC_MATCH_PATCH_ROWS_H
#define LC_MATCH_PATCH_ROWS_H
#include "shared/gather.h"

typedef struct {
  int at[TOGETHER];
} Places;

#if LC_VECTOR == 16
typedef float row_t __attribute__((ext_vector_type(32)));  // of each patch
typedef int4 each_int_t;
#define EACH_INT convert_int4
#define EACH_REAL convert_float4

static inline Places places_of(each_int_t at) {
  const Places p = {{at.x, at.y, at.z, at.w}};
  return p;
}

// Eight pixels of each patch, `by` pixels from its place.
static inline row_t rows_at(global const float* restrict image, Places p, int by) {
  const float16 a = whole_16((float16)(vload8(0, image + p.at[0] + by), vload8(0, image + p.at[1] + by)));
  const float16 b = whole_16((float16)(vload8(0, image + p.at[2] + by), vload8(0, image + p.at[3] + by)));
  return (row_t)(a, b);
}

static inline row_t along_rows(each_t value) {
  return (row_t)((float8)value.x, (float8)value.y, (float8)value.z, (float8)value.w);
}

static inline each_t sum_of_rows(row_t v) {
  const float16 p = v.lo, q = v.hi;
  const float16 a = (float16)(p.lo.lo, p.hi.lo, q.lo.lo, q.hi.lo) + (float16)(p.lo.hi, p.hi.hi, q.lo.hi, q.hi.hi);
  const float8 b = (float8)(a.s01, a.s45, a.s89, a.scd) + (float8)(a.s23, a.s67, a.sab, a.sef);
  return b.even + b.odd;
}
#else
typedef float16 row_t;
typedef int2 each_int_t;
#define EACH_INT convert_int2
#define EACH_REAL convert_float2

static inline Places places_of(each_int_t at) {
  const Places p = {{at.x, at.y}};
  return p;
}

static inline row_t rows_at(global const float* restrict image, Places p, int by) {
  return (float16)(vload8(0, image + p.at[0] + by), vload8(0, image + p.at[1] + by));
}

static inline row_t along_rows(each_t value) {
  return (float16)((float8)value.x, (float8)value.y);
}

static inline each_t sum_of_rows(row_t v) {
  const float8 a = (float8)(v.lo.lo, v.hi.lo) + (float8)(v.lo.hi, v.hi.hi);
  const float4 b = (float4)(a.lo.lo, a.hi.lo) + (float4)(a.lo.hi, a.hi.hi);
  return b.even + b.odd;
}
#endif

static inline row_t larger(row_t a, row_t b) {
  return a > b ? a : b;
}

// How far a row lies from the depth z.
static inline row_t far_from(row_t depth, row_t z) {
  const row_t away = depth - z;
  return larger(away, -away);
}

#endif
