// The dialect of files that both compilers read. On the device REAL is float; the host includes the same files through
// src/geometry/reference.h with REAL = double. Values in, struct out: no address-space pointers, no float3, no
// recursion.
#ifndef LC_SHARED_DIALECT_H
#define LC_SHARED_DIALECT_H
#ifdef LC_DEVICE
#define REAL float
#define LC_FN static inline
#define LC_LIT(x) x##f
#define LC_SQRT(x) sqrt(x)
#define LC_FABS(x) fabs(x)
// Before a loop of few rounds: PoCL's compiler else keeps what it indexes in memory.
#define LC_UNROLL _Pragma("unroll")
#endif
#endif
