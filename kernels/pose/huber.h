// The robust weight of the pose stage's residuals.
#ifndef LC_POSE_HUBER_H
#define LC_POSE_HUBER_H
#include "shared/dialect.h"

// Square root of the Huber weight of a residual of this length.
LC_FN REAL huber_factor(REAL length, float threshold) {
  if (!(threshold > 0.0f)) return LC_LIT(1.0);
  return length > threshold ? LC_SQRT(threshold / length) : (REAL)LC_LIT(1.0);
}

#endif
