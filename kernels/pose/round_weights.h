// What far detections and resting soles weigh when a solve starts, in double: for src/pose/targets.cpp and floor.cpp,
// and for GPUs that start a round by themselves (round_start.h). Read by both compilers.
#ifndef LC_POSE_ROUND_WEIGHTS_H
#define LC_POSE_ROUND_WEIGHTS_H

#ifndef LC_DEVICE
#include <cmath>
using std::sqrt;
#endif

// For how sure a sole is to rest: mm above its lowest point; heights and moves in mm at which being at rest is a
// quarter as sure.
#define LC_POSE_RESTING_MM 10.0
#define LC_POSE_NEAR_MM 30.0
#define LC_POSE_STILL_MM 20.0

// By how much the weight of a residual r is divided: Cauchy's, 2 at `scale`.
static inline double cauchy_doubt(double r_squared, double scale) {
  return 1.0 + r_squared / (scale * scale);
}

// 1 at 0, a quarter at `scale`.
static inline double nearness(double value, double scale) {
  const double k = cauchy_doubt(value * value, scale);
  return 1.0 / (k * k);
}

// How sure a point of a sole is to rest on the floor, 0..1. Heights above it, of the point and of its sole's lowest;
// across_mm: how far it moved across the line of sight.
static inline double stands_by(double height_mm, double lowest_mm, double across_mm) {
  if (height_mm >= lowest_mm + LC_POSE_RESTING_MM) return 0.0;
  return sqrt(nearness(height_mm, LC_POSE_NEAR_MM) * nearness(across_mm, LC_POSE_STILL_MM));
}

#endif
