// Sixteen or eight values from or to anywhere, for the bodies for CPUs: one instruction where the processor has it,
// which PoCL's compiler does not make of sixteen reads or writes.
#ifndef LC_SHARED_GATHER_H
#define LC_SHARED_GATHER_H

#if LC_CPU

#define LC_EIGHT_OF(p, i) (p[i.s0], p[i.s1], p[i.s2], p[i.s3], p[i.s4], p[i.s5], p[i.s6], p[i.s7])

static inline float8 gather8(global const float* restrict p, int8 i) {
  return (float8)LC_EIGHT_OF(p, i);
}

static inline int8 gather_int8(global const int* restrict p, int8 i) {
  return (int8)LC_EIGHT_OF(p, i);
}

// Eight rows of four values turned around: value k of every row.
typedef struct {
  float8 x, y, z, w;
} EightRows;

#define LC_LOWER(a, b) (float8)(a.s0, b.s0, a.s1, b.s1, a.s4, b.s4, a.s5, b.s5)
#define LC_UPPER(a, b) (float8)(a.s2, b.s2, a.s3, b.s3, a.s6, b.s6, a.s7, b.s7)

// Each vector holds one of the first four rows and the one four further.
static inline EightRows turned_rows(float8 a, float8 b, float8 c, float8 d) {
  const float8 ab = LC_LOWER(a, b), cd = LC_LOWER(c, d), ab2 = LC_UPPER(a, b), cd2 = LC_UPPER(c, d);
  const EightRows rows = {(float8)(ab.s01, cd.s01, ab.s45, cd.s45), (float8)(ab.s23, cd.s23, ab.s67, cd.s67),
                          (float8)(ab2.s01, cd2.s01, ab2.s45, cd2.s45), (float8)(ab2.s23, cd2.s23, ab2.s67, cd2.s67)};
  return rows;
}

static inline EightRows gather_rows8(global const float* restrict p, int8 i) {
  return turned_rows(
      (float8)(vload4(0, p + i.s0), vload4(0, p + i.s4)), (float8)(vload4(0, p + i.s1), vload4(0, p + i.s5)),
      (float8)(vload4(0, p + i.s2), vload4(0, p + i.s6)), (float8)(vload4(0, p + i.s3), vload4(0, p + i.s7)));
}

static inline float4 three_at(global const float* restrict p, int i) {
  return (float4)(vload2(0, p + i), p[i + 2], 0.0f);
}

// Without the fourth.
static inline EightRows gather_short_rows8(global const float* restrict p, int8 i) {
  return turned_rows((float8)(three_at(p, i.s0), three_at(p, i.s4)), (float8)(three_at(p, i.s1), three_at(p, i.s5)),
                     (float8)(three_at(p, i.s2), three_at(p, i.s6)), (float8)(three_at(p, i.s3), three_at(p, i.s7)));
}

// Sixteen rows likewise.
typedef struct {
  float16 x, y, z, w;
} SixteenRows;

#define LC_LOWER_16(a, b) \
  (float16)(a.s0, b.s0, a.s1, b.s1, a.s4, b.s4, a.s5, b.s5, a.s8, b.s8, a.s9, b.s9, a.sc, b.sc, a.sd, b.sd)
#define LC_UPPER_16(a, b) \
  (float16)(a.s2, b.s2, a.s3, b.s3, a.s6, b.s6, a.s7, b.s7, a.sa, b.sa, a.sb, b.sb, a.se, b.se, a.sf, b.sf)
#define LC_FIRST_PAIRS(a, b) (float16)(a.s01, b.s01, a.s45, b.s45, a.s89, b.s89, a.scd, b.scd)
#define LC_LAST_PAIRS(a, b) (float16)(a.s23, b.s23, a.s67, b.s67, a.sab, b.sab, a.sef, b.sef)

// Each vector holds one of the first four rows and those four, eight and twelve further; and back.
static inline SixteenRows turned_rows_16(float16 a, float16 b, float16 c, float16 d) {
  const float16 ab = LC_LOWER_16(a, b), cd = LC_LOWER_16(c, d), ab2 = LC_UPPER_16(a, b), cd2 = LC_UPPER_16(c, d);
  const SixteenRows rows = {LC_FIRST_PAIRS(ab, cd), LC_LAST_PAIRS(ab, cd), LC_FIRST_PAIRS(ab2, cd2),
                            LC_LAST_PAIRS(ab2, cd2)};
  return rows;
}

// A vector as it is: otherwise what nobody reads of it is not loaded, piece by piece.
#ifdef __AVX512F__
static inline float16 whole_16(float16 value) {
  __asm__("" : "+v"(value));
  return value;
}
#else
#define whole_16(value) (value)
#endif

static inline SixteenRows gather_rows16(global const float* restrict p, int16 i) {
  return turned_rows_16(
      whole_16((float16)(vload4(0, p + i.s0), vload4(0, p + i.s4), vload4(0, p + i.s8), vload4(0, p + i.sc))),
      whole_16((float16)(vload4(0, p + i.s1), vload4(0, p + i.s5), vload4(0, p + i.s9), vload4(0, p + i.sd))),
      whole_16((float16)(vload4(0, p + i.s2), vload4(0, p + i.s6), vload4(0, p + i.sa), vload4(0, p + i.se))),
      whole_16((float16)(vload4(0, p + i.s3), vload4(0, p + i.s7), vload4(0, p + i.sb), vload4(0, p + i.sf))));
}

// The rows that a list names.
static inline SixteenRows gather_listed16(global const float* restrict p, global const int* restrict row) {
#define LC_ROWS(k) \
  whole_16((float16)(vload4(row[k], p), vload4(row[k + 4], p), vload4(row[k + 8], p), vload4(row[k + 12], p)))
  return turned_rows_16(LC_ROWS(0), LC_ROWS(1), LC_ROWS(2), LC_ROWS(3));
#undef LC_ROWS
}

// Without the fourth.
static inline SixteenRows gather_short_rows16(global const float* restrict p, int16 i) {
  return turned_rows_16((float16)(three_at(p, i.s0), three_at(p, i.s4), three_at(p, i.s8), three_at(p, i.sc)),
                        (float16)(three_at(p, i.s1), three_at(p, i.s5), three_at(p, i.s9), three_at(p, i.sd)),
                        (float16)(three_at(p, i.s2), three_at(p, i.s6), three_at(p, i.sa), three_at(p, i.se)),
                        (float16)(three_at(p, i.s3), three_at(p, i.s7), three_at(p, i.sb), three_at(p, i.sf)));
}

// The first `lanes` values; places differ.
static inline void scatter8(float8 value, global float* restrict p, int8 i, int lanes) {
  float values[8];
  int places[8];
  vstore8(value, 0, values);
  vstore8(i, 0, places);
  for (int k = 0; k < lanes && k < 8; ++k) p[places[k]] = values[k];
}

#ifdef __AVX512F__

static inline float16 gather16(global const float* restrict p, int16 i) {
  return __builtin_ia32_gathersiv16sf((float16)0.0f, p, i, (ushort)0xffff, 4);
}

static inline int16 gather_int16(global const int* restrict p, int16 i) {
  return __builtin_ia32_gathersiv16si((int16)0, p, i, (ushort)0xffff, 4);
}

// Each with the one behind it in the upper half.
static inline uint16 gather_pairs(global const ushort* restrict p, int16 i) {
  return as_uint16(__builtin_ia32_gathersiv16si((int16)0, p, i, (ushort)0xffff, 2));
}

// The first `lanes` values; places differ.
static inline void scatter16(float16 value, global float* restrict p, int16 i, int lanes) {
  const ushort first = lanes < 16 ? (ushort)((1 << lanes) - 1) : (ushort)0xffff;
  __builtin_ia32_scattersiv16sf(p, first, i, value, 4);
}

#else

#define LC_ALL_OF(p, i)                                                                                        \
  (p[i.s0], p[i.s1], p[i.s2], p[i.s3], p[i.s4], p[i.s5], p[i.s6], p[i.s7], p[i.s8], p[i.s9], p[i.sa], p[i.sb], \
   p[i.sc], p[i.sd], p[i.se], p[i.sf])

static inline float16 gather16(global const float* restrict p, int16 i) {
  return (float16)LC_ALL_OF(p, i);
}

static inline int16 gather_int16(global const int* restrict p, int16 i) {
  return (int16)LC_ALL_OF(p, i);
}

static inline uint pair_at(global const ushort* restrict p, int i) {
  return as_uint(vload2(0, p + i));
}

static inline uint16 gather_pairs(global const ushort* restrict p, int16 i) {
  return (uint16)(pair_at(p, i.s0), pair_at(p, i.s1), pair_at(p, i.s2), pair_at(p, i.s3), pair_at(p, i.s4),
                  pair_at(p, i.s5), pair_at(p, i.s6), pair_at(p, i.s7), pair_at(p, i.s8), pair_at(p, i.s9),
                  pair_at(p, i.sa), pair_at(p, i.sb), pair_at(p, i.sc), pair_at(p, i.sd), pair_at(p, i.se),
                  pair_at(p, i.sf));
}

static inline void scatter16(float16 value, global float* restrict p, int16 i, int lanes) {
  float values[16];
  int places[16];
  vstore16(value, 0, values);
  vstore16(i, 0, places);
  for (int k = 0; k < lanes && k < 16; ++k) p[places[k]] = values[k];
}

#endif
#endif

#endif
