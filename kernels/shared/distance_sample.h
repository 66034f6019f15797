// The distance image between its pixels.
#ifndef LC_SHARED_DISTANCE_SAMPLE_H
#define LC_SHARED_DISTANCE_SAMPLE_H
#include "shared/vec.h"

typedef struct {
  REAL value;     // px, positive outside the silhouette
  Vec2 gradient;  // by u and v: exact derivative of the bilinear interpolant
} DistanceSample;

// Bilinear, fx and fy px right of and below pixel a; b is right of it, c below, d below b.
LC_FN DistanceSample distance_sample(REAL a, REAL b, REAL c, REAL d, REAL fx, REAL fy) {
  REAL top = a + fx * (b - a);
  REAL bottom = c + fx * (d - c);
  DistanceSample sample;
  sample.value = top + fy * (bottom - top);
  sample.gradient.x = (b - a) + fy * ((d - c) - (b - a));
  sample.gradient.y = bottom - top;
  return sample;
}

#endif
