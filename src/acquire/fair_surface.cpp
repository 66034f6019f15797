#include "acquire/fair_surface.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "acquire/facet_offsets.h"
#include "livecap/error.h"
#include "meshing/surface_parts.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;
using Sparse = Eigen::SparseMatrix<double>;

constexpr double kHold = 0.3;             // of one sure outline, against the smoothness of one vertex
constexpr double kMostOutlines = 3;       // more hold a vertex no better
constexpr double kLeastHold = 1e-4;       // of a vertex that none holds
constexpr double kSureMm = 25;            // lines of sight along the hull for longer tell little
constexpr double kMostMm = 40;            // that a vertex moves,
constexpr double kMostOfThickness = 0.3;  // and of the body below it
constexpr double kStepMm = 4, kLongestMm = 150, kThickestMm = 200;
constexpr double kOutMm = 3, kInMm = 4;  // of the hull: along it

// How far the line through p runs along the hull, mm.
double length_along(const Volume& hull, const Vector3d& p, const Vector3d& line) {
  double length = 0;
  for (const double side : {-1.0, 1.0})
    for (double t = kStepMm; t < kLongestMm; t += kStepMm) {
      const double outside = hull.at(p + side * t * line);
      if (outside > kOutMm || outside < -kInMm) break;
      length += kStepMm;
    }
  return length;
}

double thickness(const Volume& solid, const Vector3d& p, const Vector3d& normal) {
  double depth = kStepMm;
  while (depth < kThickestMm && solid.at(p - depth * normal) < 0) depth += kStepMm;
  return depth;
}

// w of the header.
Eigen::VectorXd holds(const std::vector<SeenOutline>& seen, const Volume& hull, const meshing::Surface& surface,
                      const std::vector<Vector3d>& normals) {
  Eigen::VectorXd held(static_cast<int>(surface.vertices.size()));
  for (int i = 0; i < held.size(); ++i) {
    const Vector3d& p = surface.vertices[i];
    double sure = 0;
    for (const SeenOutline& one : seen)
      if (!std::isnan(one.outside_mm(p, normals[i])))
        sure += 1 / (1 + std::pow(length_along(hull, p, (p - one.center).normalized()) / kSureMm, 4));
    held[i] = kHold * std::min(sure, kMostOutlines) + kLeastHold;
  }
  return held;
}

Sparse umbrella_laplacian(const std::vector<std::vector<int>>& neighbors) {
  const int n = static_cast<int>(neighbors.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1);
    for (const int other : neighbors[i])
      entries.emplace_back(i, other, -1.0 / static_cast<double>(neighbors[i].size()));
  }
  Sparse laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

}  // namespace

void fair_surface(const std::vector<SeenOutline>& seen, const Volume& hull, const Volume& solid, double lowest_mm,
                  meshing::Surface& surface) {
  const auto neighbors = meshing::neighbors_of(surface);
  const std::vector<Vector3d> normals = meshing::smooth_normals(surface, neighbors, 1);
  const Eigen::VectorXd held = holds(seen, hull, surface, normals);
  const int n = static_cast<int>(held.size());
  if (n == 0 || held.maxCoeff() <= kLeastHold) return;  // by no outline
  Eigen::MatrixX3d at(n, 3);
  for (int i = 0; i < n; ++i) at.row(i) = surface.vertices[i].transpose();

  const Sparse laplacian = umbrella_laplacian(neighbors);
  Sparse system = laplacian.transpose() * laplacian;
  system.diagonal() += held;
  const Eigen::SimplicialLDLT<Sparse> factor(system);
  if (factor.info() != Eigen::Success) throw LogicError("fairing: the system cannot be factored");
  const Eigen::MatrixX3d smooth = factor.solve(Eigen::MatrixX3d(held.asDiagonal() * at));

  std::vector<Vector3d> moves(n, Vector3d::Zero());
  for (int i = 0; i < n; ++i) {
    const Vector3d& p = surface.vertices[i];
    const Vector3d move = smooth.row(i).transpose() - p;
    if (move.dot(normals[i]) >= 0) continue;  // outside of the hull there is nothing
    const double most = std::min(kMostMm, kMostOfThickness * thickness(solid, p, normals[i]));
    moves[i] = move * std::min(1.0, most / move.norm()) * ramp_above(lowest_mm, p);
  }
  for (int i = 0; i < n; ++i) surface.vertices[i] += moves[i];
}

}  // namespace livecap::acquire
