// Sums of weights that are the same in whatever order they are added, on host and device: of whole numbers of 2^-31.
// From 2^32 on they would wrap around. Read by both compilers.
#ifndef LC_SHARED_EXACT_SUM_H
#define LC_SHARED_EXACT_SUM_H

#ifdef LC_DEVICE
typedef long lc_exact_t;
#else
#include <cstdint>
typedef int64_t lc_exact_t;
#endif

#define LC_EXACT(weight) ((lc_exact_t)((weight)*2147483648.0f))
// Pictures of more px are too large for sums of px^2 of all that they may show, each of which may count so many times.
#define LC_EXACT_MOST_PX 8388608
#define LC_EXACT_MOST_SHARE 256
#define LC_EXACT_UNIT 4.656612873077393e-10

#endif
