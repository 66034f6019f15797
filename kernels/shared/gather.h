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
