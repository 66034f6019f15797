#include "meshing/surface_parts.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace livecap::meshing {

using Eigen::Vector3d;

Surface surface_of(const Mesh& mesh) {
  Surface surface;
  const auto& p = mesh.positions;
  for (size_t i = 0; i < p.size(); i += 3) surface.vertices.emplace_back(p[i], p[i + 1], p[i + 2]);
  const auto& t = mesh.triangles;
  for (size_t i = 0; i < t.size(); i += 3) surface.triangles.emplace_back(t[i], t[i + 1], t[i + 2]);
  return surface;
}

double mean_edge(const Surface& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles) sum += (surface.vertices[t[0]] - surface.vertices[t[1]]).norm();
  return sum / static_cast<double>(std::max<size_t>(1, surface.triangles.size()));
}

std::vector<Vector3d> vertex_normals(const Surface& surface) {
  std::vector<Vector3d> normals(surface.vertices.size(), Vector3d::Zero());
  for (const auto& t : surface.triangles) {
    const Vector3d& a = surface.vertices[t[0]];
    const Vector3d n = (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a);
    for (int k = 0; k < 3; ++k) normals[t[k]] += n;
  }
  for (Vector3d& n : normals) n.normalize();
  return normals;
}

std::vector<std::vector<int>> neighbors_of(const Surface& surface) {
  std::vector<std::vector<int>> neighbors(surface.vertices.size());
  for (const auto& t : surface.triangles)
    for (int k = 0; k < 3; ++k) neighbors[t[k]].push_back(t[(k + 1) % 3]);
  return neighbors;
}

std::vector<Vector3d> smooth_normals(const Surface& surface, const std::vector<std::vector<int>>& neighbors,
                                     int rounds) {
  std::vector<Vector3d> normals = vertex_normals(surface);
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vector3d> next = normals;
    for (size_t i = 0; i < normals.size(); ++i) {
      for (int other : neighbors[i]) next[i] += 0.5 * normals[other];
      next[i].normalize();
    }
    normals.swap(next);
  }
  return normals;
}

}  // namespace livecap::meshing
