// Points as the files have them: three numbers each, on end.
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

inline Eigen::Vector3d point(std::span<const float> points, size_t i) {
  return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
}

// Throws LogicError.
inline void require_same_points(std::span<const float> a, std::span<const float> b) {
  if (a.size() == b.size() && a.size() % 3 == 0) return;
  throw LogicError(format("point lists of %zu and %zu numbers cannot be compared", a.size(), b.size()));
}

}  // namespace livecap
