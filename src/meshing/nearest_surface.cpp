#include "meshing/nearest_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "livecap/error.h"

namespace livecap::meshing {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

}  // namespace

// Ericson, Real-Time Collision Detection, 5.1.5.
std::array<double, 3> nearest_in_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {1, 0, 0};  // no area
  return {va / sum, vb / sum, vc / sum};
}

NearestSurface::NearestSurface(const Surface& surface, double cell) : surface_(surface), cell_(cell) {
  if (surface.triangles.empty()) throw LogicError("nearest surface of no triangles");
  Vector3d high = Vector3d::Constant(-1e300);
  low_ = Vector3d::Constant(1e300);
  for (const Vector3d& v : surface.vertices) low_ = low_.cwiseMin(v), high = high.cwiseMax(v);
  counts_ = ((high - low_) / cell_).cast<int>() + Vector3i::Ones();
  for (size_t t = 0; t < surface.triangles.size(); ++t) {
    Vector3d a = surface.vertices[surface.triangles[t][0]], b = a;
    for (int k = 1; k < 3; ++k) {
      a = a.cwiseMin(surface.vertices[surface.triangles[t][k]]);
      b = b.cwiseMax(surface.vertices[surface.triangles[t][k]]);
    }
    const Vector3i from = ((a - low_) / cell_).cast<int>(), to = ((b - low_) / cell_).cast<int>();
    for (int z = from.z(); z <= to.z(); ++z)
      for (int y = from.y(); y <= to.y(); ++y)
        for (int x = from.x(); x <= to.x(); ++x) cells_[key({x, y, z})].push_back(static_cast<int>(t));
  }
}

SurfacePoint NearestSurface::find(const Vector3d& p) const {
  SurfacePoint best;
  best.distance = std::numeric_limits<double>::infinity();
  // The cell of p, or the nearest one; then shells of cells until none can hold anything nearer.
  const Vector3d q =
      ((p - low_) / cell_).cwiseMax(Vector3d::Zero()).cwiseMin((counts_ - Vector3i::Ones()).cast<double>());
  const Vector3i home = q.cast<int>();
  const double outside = (p - (low_ + cell_ * q)).norm();
  for (int shell = 0; shell <= counts_.maxCoeff(); ++shell) {
    if (best.distance < (shell - 1) * cell_ - outside) break;
    for (int z = home.z() - shell; z <= home.z() + shell; ++z)
      for (int y = home.y() - shell; y <= home.y() + shell; ++y)
        for (int x = home.x() - shell; x <= home.x() + shell; ++x) {
          const Vector3i at(x, y, z);
          if ((at - home).cwiseAbs().maxCoeff() != shell) continue;
          if (at.minCoeff() < 0 || x >= counts_.x() || y >= counts_.y() || z >= counts_.z()) continue;
          const auto found = cells_.find(key(at));
          if (found == cells_.end()) continue;
          for (int t : found->second) {
            const auto& tri = surface_.triangles[t];
            const auto w =
                nearest_in_triangle(p, surface_.vertices[tri[0]], surface_.vertices[tri[1]], surface_.vertices[tri[2]]);
            const Vector3d on =
                w[0] * surface_.vertices[tri[0]] + w[1] * surface_.vertices[tri[1]] + w[2] * surface_.vertices[tri[2]];
            if (const double d = (on - p).norm(); d < best.distance) best = {t, w, on, d};
          }
        }
  }
  return best;
}

}  // namespace livecap::meshing
