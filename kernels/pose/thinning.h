// Which of more vertices than there may be a solve has rows for. Read by both compilers, so that both choose the same
// to the bit.
#ifndef LC_POSE_THINNING_H
#define LC_POSE_THINNING_H
#include "shared/exact_sum.h"

#ifndef LC_DEVICE
#include <cmath>
using std::floor;
#endif

// Of a total weight (LC_EXACT) in n equal shares. No sum of products: compilers may or may not round those twice.
typedef struct {
  lc_exact_t middle;
  double each, per_weight;
} Shares;

static inline Shares shares_of(lc_exact_t total, int n) {
  const Shares s = {total / n / 2, (double)total / (double)n, (double)n / (double)total};
  return s;
}

// How many there are, rounded, in the sum of the weights so far: a vertex stands for as many as its own weight adds.
static inline double shares_until(lc_exact_t sum, Shares s) {
  return floor((double)(sum + s.middle) * s.per_weight);
}

// Whether the vertex at `place` of n_all is one of n that are spread evenly.
static inline int is_spread(lc_exact_t place, lc_exact_t n_all, lc_exact_t n) {
  const lc_exact_t i = (place * n + n_all - 1) / n_all;
  return i < n && i * n_all / n == place;
}

#endif
