// Triangle meshes as packed arrays, their one-rings and normals.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace livecap {

struct Mesh {
  std::vector<float> positions;    // [3*n_vertices] mm, xyz packed
  std::vector<int32_t> triangles;  // [3*n_triangles] vertex indices, counter-clockwise seen from outside
  int n_vertices() const { return static_cast<int>(positions.size() / 3); }
  int n_triangles() const { return static_cast<int>(triangles.size() / 3); }
};

// One-ring neighbours in compressed rows: those of vertex i are neighbors[offsets[i] .. offsets[i+1]), ascending.
struct OneRing {
  std::vector<int32_t> offsets;    // [n_vertices+1]
  std::vector<int32_t> neighbors;  // [offsets.back()]
};

OneRing one_ring(int n_vertices, std::span<const int32_t> triangles);

// The triangles around each vertex in compressed rows: those of vertex i are triangles[offsets[i] .. offsets[i+1]),
// ascending.
struct TriangleFans {
  std::vector<int32_t> offsets;    // [n_vertices+1]
  std::vector<int32_t> triangles;  // [3*n_triangles] triangle indices
};

TriangleFans triangle_fans(int n_vertices, std::span<const int32_t> triangles);

// Area-weighted unit vertex normals [3*n]; zero for a vertex without area.
std::vector<float> vertex_normals(std::span<const float> positions, std::span<const int32_t> triangles);

// Number of connected components over triangle edges; vertices in no triangle count one each.
int connected_components(int n_vertices, std::span<const int32_t> triangles);

// [n] a third of the triangles around each vertex, mm^2.
std::vector<float> vertex_areas(const Mesh& mesh);

}  // namespace livecap
