// Which of up to 32 conditions hold, as the bits of one number. A condition that holds is -1. PoCL's any() looks at one
// lane after the other.
#ifndef LC_SHARED_BITS_H
#define LC_SHARED_BITS_H

#if LC_CPU && defined(__AVX512DQ__) && defined(__AVX512VL__)

// A comparison's result is such bits there, and vectors are only made of them.
static inline uint bits_of_8(int8 condition) {
  return (uchar)__builtin_ia32_cvtd2mask256(condition);
}

static inline uint bits_of_16(int16 condition) {
  return (ushort)__builtin_ia32_cvtd2mask512(condition);
}

static inline int any_of_8(int8 condition) {
  return bits_of_8(condition) != 0;
}

static inline int any_of_16(int16 condition) {
  return bits_of_16(condition) != 0;
}

#elif LC_CPU && defined(__AVX__)

static inline uint bits_of_8(int8 condition) {
  return (uint)__builtin_ia32_movmskps256(as_float8(condition));
}

static inline uint bits_of_16(int16 condition) {
  return bits_of_8(condition.lo) | bits_of_8(condition.hi) << 8;
}

static inline int any_of_8(int8 condition) {
  return bits_of_8(condition) != 0;
}

static inline int any_of_16(int16 condition) {
  return bits_of_8(condition.lo | condition.hi) != 0;
}

#else

static inline uint bits_of_8(int8 condition) {
  const int8 bits = condition & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
  const int4 four = bits.lo | bits.hi;
  return (uint)(four.x | four.y | four.z | four.w);
}

static inline uint bits_of_16(int16 condition) {
  const int16 bits = condition & (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
  const int8 eight = bits.lo | bits.hi;
  const int4 four = eight.lo | eight.hi;
  return (uint)(four.x | four.y | four.z | four.w);
}

static inline int any_of_8(int8 condition) {
  return any(condition);
}

static inline int any_of_16(int16 condition) {
  return any(condition);
}

#endif

// The lowest of some bits, not none.
static inline int lowest_bit(uint bits) {
  return 31 - clz(bits & -bits);
}

#endif
