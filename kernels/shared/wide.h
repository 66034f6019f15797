// Sixteen or eight values of a row at once, as the bodies for CPUs work, and some for GPUs where rows are aligned.
// PoCL 3.1 makes four stores of one vstore16, and of one of bytes sixteen.
#ifndef LC_SHARED_WIDE_H
#define LC_SHARED_WIDE_H

typedef float16 __attribute__((aligned(4))) UnalignedFloat16;
typedef float8 __attribute__((aligned(4))) UnalignedFloat8;
typedef int16 __attribute__((aligned(4))) UnalignedInt16;
typedef int8 __attribute__((aligned(4))) UnalignedInt8;
typedef uchar16 __attribute__((aligned(1))) UnalignedUchar16;
typedef ushort16 __attribute__((aligned(2))) UnalignedUshort16;

static inline void store16(float16 value, global float* to) {
  *(global UnalignedFloat16*)to = value;
}

static inline void store8(float8 value, global float* to) {
  *(global UnalignedFloat8*)to = value;
}

static inline void store_int16(int16 value, global int* to) {
  *(global UnalignedInt16*)to = value;
}

static inline void store_int8(int8 value, global int* to) {
  *(global UnalignedInt8*)to = value;
}

static inline void store_uchar16(uchar16 value, global uchar* to) {
  *(global UnalignedUchar16*)to = value;
}

static inline void store_ushort16(ushort16 value, global ushort* to) {
  *(global UnalignedUshort16*)to = value;
}

#endif
