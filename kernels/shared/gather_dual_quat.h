// The dual quaternion of a bone for each lane. shared/lanes.h comes first.
#ifndef LC_SHARED_GATHER_DUAL_QUAT_H
#define LC_SHARED_GATHER_DUAL_QUAT_H
#include "shared/dual_quat.h"

// From p[i] on.
#if LANES == 1
// Of any address space.
#define gather_dual_quat(p, i) \
  ((DualQuat){(p)[i], (p)[(i) + 1], (p)[(i) + 2], (p)[(i) + 3], (p)[(i) + 4], (p)[(i) + 5], (p)[(i) + 6], (p)[(i) + 7]})
#else
static inline DualQuat gather_dual_quat(global const float* restrict p, LaneInt i) {
  const Vec4 real = gather_vec4(p, i), dual = gather_vec4(p, i + 4);
  const DualQuat q = {real.x, real.y, real.z, real.w, dual.x, dual.y, dual.z, dual.w};
  return q;
}
#endif

#endif
