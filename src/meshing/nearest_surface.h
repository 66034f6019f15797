// The nearest point of a triangle mesh, through a grid of triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "meshing/isosurface.h"

namespace livecap::meshing {

struct SurfacePoint {
  int triangle = -1;
  std::array<double, 3> weights{};  // barycentric
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double distance = 0;
};

// Barycentric weights of the point of triangle a, b, c nearest to p.
std::array<double, 3> nearest_in_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                          const Eigen::Vector3d& c);

class NearestSurface {
 public:
  // Keeps a reference to the surface, which must have triangles (LogicError). cell: side of the grid's cells, about the
  // longest usual edge.
  NearestSurface(const Surface& surface, double cell);

  SurfacePoint find(const Eigen::Vector3d& p) const;

 private:
  int64_t key(const Eigen::Vector3i& cell) const {
    return (static_cast<int64_t>(cell.z()) * counts_.y() + cell.y()) * counts_.x() + cell.x();
  }

  const Surface& surface_;
  double cell_;
  Eigen::Vector3d low_;
  Eigen::Vector3i counts_;
  std::unordered_map<int64_t, std::vector<int>> cells_;
};

}  // namespace livecap::meshing
