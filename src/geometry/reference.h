// The shared formulas of kernels/shared and kernels/terms in double precision: the same files the device compiles, so
// that a formula exists once. Everything is in livecap::reference.
#pragma once

#include <cmath>

#define REAL double
#define LC_FN inline
#define LC_LIT(x) x
#define LC_SQRT(x) std::sqrt(x)
#define LC_FABS(x) std::fabs(x)
#define LC_UNROLL

namespace livecap::reference {

#include "shared/vec.h"
//
#include "shared/camera.h"
#include "shared/dual_quat.h"
//
#include "terms/acceleration.cl"
#include "terms/anatomic.cl"
#include "terms/depth.cl"
#include "terms/edge.cl"
#include "terms/floor.cl"
#include "terms/keypoint_2d.cl"
#include "terms/keypoint_3d.cl"
#include "terms/match.cl"
#include "terms/photo.cl"
#include "terms/rest.cl"
#include "terms/shading.cl"
#include "terms/silhouette.cl"
#include "terms/smooth.cl"
#include "terms/temporal.cl"
#include "terms/velocity.cl"

}  // namespace livecap::reference

#undef REAL
#undef LC_FN
#undef LC_LIT
#undef LC_SQRT
#undef LC_FABS
#undef LC_UNROLL
