// What vertices that the picture shows weigh in stage I. Read by both compilers, so that a device that chooses by
// itself has the host's weights to the bit. Divided in double, on devices by doubles from memory: floats, or doubles
// that were floats, are divided less exactly there than on the host.
#ifndef LC_SHARED_SEEN_WEIGHT_H
#define LC_SHARED_SEEN_WEIGHT_H
#include "shared/exact_sum.h"

#ifndef LC_DEVICE
#include <cmath>
using std::sqrt;
#endif

// Of px^2 where px_of_one weigh 1.
static inline float seen_weight(float px, double px_of_one) {
  return (float)((double)px / px_of_one);
}

// Sums of px^2 (LC_EXACT) that a limb shows end here, so that they cannot wrap around.
#define LC_MOST_LIMB_PX (LC_EXACT((float)(LC_EXACT_MOST_PX / 2)))

// px_of_one of a limb that shows px^2 (LC_EXACT): it weighs 1 altogether, less where it shows less than least_px.
static inline double limb_px_of_one(lc_exact_t px, float least_px) {
  const double seen = (double)(px < LC_MOST_LIMB_PX ? px : LC_MOST_LIMB_PX) * LC_EXACT_UNIT;
  return seen > (double)least_px ? seen : (double)least_px;
}

// Brightness in deviations of what the light leaves unexplained.
static inline float in_deviations(float brightness, double deviation) {
  return (float)((double)brightness / deviation);
}

// Root of what a row's square counts in a term of this weight.
static inline float row_root(double term, float weight) {
  return (float)sqrt(term * (double)weight);
}

// The same of each of n contour vertices that stand for n_all.
static inline float contour_row_root(double term, double n_all, double n) {
  return n > 0.0 ? (float)sqrt(term * n_all / n) : 0.0f;
}

#endif
