// Hanging cloth between where it hangs and where legs carry it. Over the vertices, LANES each.
#include "shared/lanes.h"
//
#include "cloth/layout.h"

// A vertex that legs carry by d = carried - hung, at an angle a with its normal times its side, is left at hung + s d
// with s = 1 - opening (1 - cos a) / 2: all of d where they push it outwards, 1 - opening of it where they leave it.
// `start` and `start_before` move by as much. All [3n] mm but normals, [3n] unit, and side, [n] 1 or -1.
kernel void open_folds(int n, float opening, global const float* restrict hung, global const float* restrict normals,
                       global const float* restrict side, global float* restrict carried, global float* restrict start,
                       global float* restrict start_before) {
  const int first = FIRST_ROW;
  if (first >= n) return;
  const LaneInt i = lane_rows(first, n);
  const Vec3 at = gather_vec3(carried, i), by = sub3(at, gather_vec3(hung, i));
  const REAL cosine = gather(side, i) * dot3(by, gather_vec3(normals, i)) / (norm3(by) + LC_CLOTH_TINY);
  const Vec3 back = scale3(by, -0.5f * opening * (1.0f - cosine));
  store_vec3(add3(at, back), carried, first, n);
  store_vec3(add3(gather_vec3(start, i), back), start, first, n);
  store_vec3(add3(gather_vec3(start_before, i), back), start_before, first, n);
}
