// Signed distances of simple solids (negative inside) and their smooth unions. mm.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace livecap::synth {

using Vec3 = Eigen::Vector3d;

// Polynomial smooth minimum: two solids melt together over a zone of width k.
inline double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0);
  return std::min(a, b) - h * h / (4 * k);
}

inline double smooth_max(double a, double b, double k) {
  return -smooth_min(-a, -b, k);
}

// Position of p along the segment a-b, clamped to [0,1].
inline double segment_parameter(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  return std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
}

inline double segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  return (p - a - segment_parameter(p, a, b) * (b - a)).norm();
}

// A limb: a segment whose radius goes linearly from ra at a to rb at b.
inline double tapered_capsule(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb) {
  const double t = segment_parameter(p, a, b);
  return (p - a - t * (b - a)).norm() - (ra + t * (rb - ra));
}

// First-order distance to an axis-aligned ellipsoid.
inline double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = (p - center).cwiseQuotient(radii);
  const double k0 = q.norm();
  const double k1 = q.cwiseQuotient(radii).norm();
  return k1 > 1e-9 ? k0 * (k0 - 1) / k1 : -radii.minCoeff();
}

}  // namespace livecap::synth
