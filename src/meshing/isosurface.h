// The zero surface of a signed distance as a closed triangle mesh, by marching tetrahedra (no ambiguous cases, so the
// result is always a manifold), thinned by quadric edge collapses.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

namespace livecap::meshing {

struct Surface {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;  // counter-clockwise seen from outside
};

using DistanceField = std::function<double(const Eigen::Vector3d&)>;

// The field must be positive on the border of the box low..high and must not grow faster than twice the distance.
Surface extract_surface(const DistanceField& distance, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                        double step);

// Quadric decimation to about target_vertices with edges no longer than max_edge, then edge flips and tangential
// relaxation that even the triangles out, each vertex put back on the zero of `distance`. Where the vertices do not
// suffice for max_edge it gives way. Keeps the surface closed. For surfaces not much finer than wanted; of others the
// flat parts become as coarse as max_edge allows and the rest stays as fine as it was: see meshing/remesh.h.
Surface decimate_surface(const Surface& fine, int target_vertices, double max_edge, const DistanceField& distance);

}  // namespace livecap::meshing
