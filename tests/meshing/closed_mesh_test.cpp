// Which edges of a closed mesh may be collapsed.
#include "meshing/closed_mesh.h"

#include <gtest/gtest.h>

#include <array>

namespace livecap {
namespace {

using TestedMesh = meshing::ClosedMesh<OpenMesh::DefaultTraits>;

TestedMesh mesh_of(int n_vertices, const std::vector<std::array<int, 3>>& faces) {
  TestedMesh mesh;
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.request_halfedge_status();
  for (int i = 0; i < n_vertices; ++i) mesh.add_vertex({float(i % 3), float(i * i % 5), float(i)});
  for (const auto& f : faces)
    mesh.add_face(OpenMesh::VertexHandle(f[0]), OpenMesh::VertexHandle(f[1]), OpenMesh::VertexHandle(f[2]));
  return mesh;
}

int collapsible(TestedMesh& mesh) {
  int n = 0;
  for (const auto h : mesh.halfedges()) n += mesh.is_collapse_ok(h);
  return n;
}

TEST(ClosedMesh, ATetrahedronIsTheLeastThereIs) {
  TestedMesh mesh = mesh_of(4, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
  EXPECT_EQ(collapsible(mesh), 0);
}

TEST(ClosedMesh, AnyEdgeOfAnOctahedronMayGo) {
  TestedMesh mesh =
      mesh_of(6, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
  EXPECT_EQ(collapsible(mesh), 24);
}

}  // namespace
}  // namespace livecap
