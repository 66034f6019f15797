// A signed distance on a grid: what a hull or a scan becomes before it is a surface, and how to ask whether a point is
// inside the body.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "meshing/isosurface.h"

namespace livecap {

struct Volume {
  int nx = 0, ny = 0, nz = 0;                     // nodes
  Eigen::Vector3d low = Eigen::Vector3d::Zero();  // mm, of node (0,0,0)
  double step = 0;                                // mm
  std::vector<float> distance;                    // [nx*ny*nz] mm, negative inside, x fastest

  size_t size() const { return static_cast<size_t>(nx) * ny * nz; }
  size_t index(int x, int y, int z) const { return (static_cast<size_t>(z) * ny + y) * nx + x; }
  Eigen::Vector3d high() const { return low + step * Eigen::Vector3d(nx - 1, ny - 1, nz - 1); }

  // Trilinear; outside of the grid the border's value plus the way to it.
  double at(const Eigen::Vector3d& p) const;
};

// Nodes that cover low..high, mm. Throws ConfigError when these are more than 2^28 (a gigabyte), or not finite.
Volume make_volume(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double step);

// The box of the nodes whose distance is below `reach`, and as much around it; low > high when there is none.
std::pair<Eigen::Vector3d, Eigen::Vector3d> bounds_within(const Volume& volume, double reach);

// Gaussian with this standard deviation, in mm. What lies deeper than `keep_mm` stays inside, so that thin parts
// (hands, toes) are not blurred away.
void blur(Volume& volume, double sigma_mm, double keep_mm = 1e9);

// Keeps the largest solid, fills its cavities, makes the grid's border outside. Returns how many other solids of more
// than one litre were dropped.
int keep_largest_solid(Volume& volume);

// The closed surface at distance 0. Throws ConfigError when there is none.
meshing::Surface surface_of(const Volume& volume);

}  // namespace livecap
