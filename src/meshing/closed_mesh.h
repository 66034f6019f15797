// OpenMesh's triangle mesh, for surfaces without a boundary.
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <vector>

namespace livecap::meshing {

template <class Traits>
class ClosedMesh : public OpenMesh::TriMesh_ArrayKernelT<Traits> {
 public:
  // Instead of the library's, which Debian compiles with assertions: these cost half of a decimation. The link
  // condition: what is beside both ends are the tips of the edge's two triangles, and nothing else; and no tip loses
  // its third edge, as those of a tetrahedron would, which a small hollow can become.
  bool is_collapse_ok(OpenMesh::HalfedgeHandle edge) {
    const auto other = this->opposite_halfedge_handle(edge);
    const auto from = this->from_vertex_handle(edge), to = this->to_vertex_handle(edge);
    const auto left = this->to_vertex_handle(this->next_halfedge_handle(edge));
    const auto right = this->to_vertex_handle(this->next_halfedge_handle(other));
    if (this->status(this->edge_handle(edge)).deleted() || this->status(from).deleted() || this->status(to).deleted() ||
        left == right || this->valence(left) <= 3 || this->valence(right) <= 3)
      return false;
    beside_.clear();
    for (const auto vertex : this->vv_range(from))
      if (vertex != left && vertex != right) beside_.push_back(vertex);
    return std::none_of(this->cvv_begin(to), this->cvv_end(to), [&](const auto vertex) {
      return std::find(beside_.begin(), beside_.end(), vertex) != beside_.end();
    });
  }

 private:
  std::vector<OpenMesh::VertexHandle> beside_;
};

}  // namespace livecap::meshing
