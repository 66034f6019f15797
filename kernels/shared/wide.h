// Sixteen or eight values of a row at once, as the bodies for CPUs work, and some for GPUs where rows are aligned.
// PoCL 3.1 makes four stores of one vstore16, and of one of bytes sixteen; other compilers need not let a type be less
// aligned.
#ifndef LC_SHARED_WIDE_H
#define LC_SHARED_WIDE_H

#if LC_CPU && LC_POCL
typedef float16 __attribute__((aligned(4))) UnalignedFloat16;
typedef float8 __attribute__((aligned(4))) UnalignedFloat8;
typedef int16 __attribute__((aligned(4))) UnalignedInt16;
typedef int8 __attribute__((aligned(4))) UnalignedInt8;
typedef uchar16 __attribute__((aligned(1))) UnalignedUchar16;
typedef ushort16 __attribute__((aligned(2))) UnalignedUshort16;
#define STORE_WIDE(Unaligned, n, value, to) *(global Unaligned*)(to) = (value)
#else
#define STORE_WIDE(Unaligned, n, value, to) vstore##n(value, 0, to)
#endif

static inline void store16(float16 value, global float* to) {
  STORE_WIDE(UnalignedFloat16, 16, value, to);
}

static inline void store8(float8 value, global float* to) {
  STORE_WIDE(UnalignedFloat8, 8, value, to);
}

static inline void store_int16(int16 value, global int* to) {
  STORE_WIDE(UnalignedInt16, 16, value, to);
}

static inline void store_int8(int8 value, global int* to) {
  STORE_WIDE(UnalignedInt8, 8, value, to);
}

static inline void store_uchar16(uchar16 value, global uchar* to) {
  STORE_WIDE(UnalignedUchar16, 16, value, to);
}

static inline void store_ushort16(ushort16 value, global ushort* to) {
  STORE_WIDE(UnalignedUshort16, 16, value, to);
}

#endif
