// Which of up to 32 conditions hold, as the bits of one number.
#ifndef LC_SHARED_BITS_H
#define LC_SHARED_BITS_H

// A bit for each that holds (-1).
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

// The lowest of some bits, not none.
static inline int lowest_bit(uint bits) {
  return 31 - clz(bits & -bits);
}

#endif
