#include "geometry/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/disjoint_sets.h"

namespace livecap {

OneRing one_ring(int n_vertices, std::span<const int32_t> triangles) {
  std::vector<std::vector<int32_t>> rings(n_vertices);
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      const int32_t a = triangles[t + k];
      const int32_t b = triangles[t + (k + 1) % 3];
      rings[a].push_back(b);
      rings[b].push_back(a);
    }
  }
  OneRing result;
  result.offsets.push_back(0);
  for (auto& ring : rings) {
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    result.neighbors.insert(result.neighbors.end(), ring.begin(), ring.end());
    result.offsets.push_back(static_cast<int32_t>(result.neighbors.size()));
  }
  return result;
}

TriangleFans triangle_fans(int n_vertices, std::span<const int32_t> triangles) {
  TriangleFans fans{std::vector<int32_t>(n_vertices + 1, 0), std::vector<int32_t>(triangles.size())};
  for (const int32_t v : triangles) ++fans.offsets[v + 1];
  for (int i = 0; i < n_vertices; ++i) fans.offsets[i + 1] += fans.offsets[i];
  std::vector<int32_t> next(fans.offsets.begin(), fans.offsets.end() - 1);
  for (size_t k = 0; k < triangles.size(); ++k) fans.triangles[next[triangles[k]]++] = static_cast<int32_t>(k / 3);
  return fans;
}

std::vector<float> vertex_normals(std::span<const float> positions, std::span<const int32_t> triangles) {
  std::vector<float> normals(positions.size(), 0.f);
  auto point = [&](int32_t i) { return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * i); };
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const Eigen::Vector3f a = point(triangles[t]);
    const Eigen::Vector3f n = (point(triangles[t + 1]) - a).cross(point(triangles[t + 2]) - a);
    for (int k = 0; k < 3; ++k) Eigen::Map<Eigen::Vector3f>(normals.data() + 3 * triangles[t + k]) += n;
  }
  for (size_t i = 0; i < normals.size(); i += 3) {
    Eigen::Map<Eigen::Vector3f> n(normals.data() + i);
    const float length = n.norm();
    if (length > 1e-12f) n /= length;
  }
  return normals;
}

int connected_components(int n_vertices, std::span<const int32_t> triangles) {
  DisjointSets sets(n_vertices);
  int components = n_vertices;
  for (size_t t = 0; t + 2 < triangles.size(); t += 3)
    for (int k = 1; k < 3; ++k) components -= sets.join(triangles[t], triangles[t + k]);
  return components;
}

std::vector<float> vertex_areas(const Mesh& mesh) {
  std::vector<float> areas(mesh.n_vertices(), 0.0f);
  const auto point = [&](int i) { return Eigen::Map<const Eigen::Vector3f>(&mesh.positions[3 * i]); };
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const int32_t* c = &mesh.triangles[3 * t];
    const float third = (point(c[1]) - point(c[0])).cross(point(c[2]) - point(c[0])).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[c[k]] += third;
  }
  return areas;
}

}  // namespace livecap
