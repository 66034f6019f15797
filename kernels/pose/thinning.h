// Which of more vertices than there may be a solve has rows for. Read by both compilers, so that both choose the same
// to the bit.
#ifndef LC_POSE_THINNING_H
#define LC_POSE_THINNING_H
#include "shared/exact_sum.h"

#ifndef LC_DEVICE
#include <cmath>
using std::floor;
#endif

// How many shares of a total weight there are in the sum of the weights (LC_EXACT) so far: a vertex stands for as many
// as its own weight adds.
static inline double shares_until(lc_exact_t sum, double share) {
  return floor((double)sum / share + 0.5);
}

// Whether the vertex at `place` of n_all is one of n that are spread evenly.
static inline int is_spread(lc_exact_t place, lc_exact_t n_all, lc_exact_t n) {
  const lc_exact_t i = (place * n + n_all - 1) / n_all;
  return i < n && i * n_all / n == place;
}

#endif
