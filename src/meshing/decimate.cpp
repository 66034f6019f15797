// decimate_surface of isosurface.h.
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <algorithm>
#include <cmath>

#include "meshing/closed_mesh.h"
#include "meshing/isosurface.h"

namespace livecap::meshing {

namespace {

struct DecimateTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using TriMesh = ClosedMesh<DecimateTraits>;
using Point = TriMesh::Point;

// Twice the area over the square of the longest edge: 0.87 for an equilateral triangle, 0 for a sliver.
double roundness(const Point& a, const Point& b, const Point& c) {
  return OpenMesh::cross(b - a, c - a).norm() / std::max({(a - b).sqrnorm(), (b - c).sqrnorm(), (c - a).sqrnorm()});
}

// Forbids collapses that would leave an edge longer than the limit or a sliver: cloth needs evenly spread vertices,
// which the quadrics of a flat or conical piece do not ask for.
template <class MeshT>
class ModShape : public OpenMesh::Decimater::ModBaseT<MeshT> {
 public:
  DECIMATING_MODULE(ModShape, MeshT, Shape);
  explicit ModShape(MeshT& mesh) : Base(mesh, true) {}
  void set_max_edge(double length) { max_edge_ = length; }
  void set_least_roundness(double roundness) { least_roundness_ = roundness; }

  float collapse_priority(const CollapseInfo& info) override {
    const MeshT& mesh = Base::mesh();
    double worst_before = 1, worst_after = 1;
    for (const auto half_edge : mesh.voh_range(info.v0)) {
      const auto a = mesh.to_vertex_handle(half_edge);
      const auto b = mesh.to_vertex_handle(mesh.next_halfedge_handle(half_edge));
      const Point pa = mesh.point(a), pb = mesh.point(b);
      worst_before = std::min(worst_before, roundness(info.p0, pa, pb));
      if (a == info.v1 || b == info.v1) continue;
      if ((pa - info.p1).sqrnorm() > max_edge_ * max_edge_) return Base::ILLEGAL_COLLAPSE;
      worst_after = std::min(worst_after, roundness(info.p1, pa, pb));
    }
    return worst_after > std::min(least_roundness_, worst_before) ? Base::LEGAL_COLLAPSE : Base::ILLEGAL_COLLAPSE;
  }

 private:
  double max_edge_ = 1e9, least_roundness_ = 0.15;
};

double smallest_angle(const Point& a, const Point& b, const Point& c) {
  const auto angle = [](const Point& at, const Point& p, const Point& q) {
    return std::atan2(OpenMesh::cross(p - at, q - at).norm(), OpenMesh::dot(p - at, q - at));
  };
  return std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
}

// Turns edges whose two triangles get a better smallest angle that way, unless the surface is creased there.
void flip_edges(TriMesh& mesh) {
  for (const auto edge : mesh.edges()) {
    if (!mesh.is_flip_ok(edge)) continue;
    const auto h = mesh.halfedge_handle(edge, 0);
    const auto o = mesh.opposite_halfedge_handle(h);
    const Point a = mesh.point(mesh.from_vertex_handle(h)), b = mesh.point(mesh.to_vertex_handle(h));
    const Point c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
    const Point d = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(o)));
    const Point n0 = OpenMesh::cross(b - a, c - a), n1 = OpenMesh::cross(d - a, b - a);
    const Point m0 = OpenMesh::cross(d - c, b - c), m1 = OpenMesh::cross(a - c, d - c);
    const auto flat = [](const Point& p, const Point& q) { return OpenMesh::dot(p, q) > 0.94 * p.norm() * q.norm(); };
    if (!flat(n0, n1) || !flat(m0, m1) || !flat(n0, m0) || !flat(n0, m1)) continue;
    const double before = std::min(smallest_angle(a, b, c), smallest_angle(a, d, b));
    const double after = std::min(smallest_angle(c, d, b), smallest_angle(c, a, d));
    if (after > before + 0.02) mesh.flip(edge);
  }
}

Point field_gradient(const DistanceField& distance, const Point& p) {
  constexpr double kStep = 0.5;
  Point g(0, 0, 0);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d high(p[0], p[1], p[2]), low = high;
    high[axis] += kStep;
    low[axis] -= kStep;
    g[axis] = (distance(high) - distance(low)) / (2 * kStep);
  }
  return g;
}

// Moves each vertex towards the mean of its neighbours within the tangent plane, then back onto the surface. A move
// that turns a triangle over is undone.
void relax(TriMesh& mesh, const DistanceField& distance, double strength) {
  for (const auto v : mesh.vertices()) {
    const Point p = mesh.point(v);
    Point mean(0, 0, 0);
    double count = 0;
    for (const auto n : mesh.vv_range(v)) mean += mesh.point(n), ++count;
    mean /= count;
    Point normal = field_gradient(distance, p);
    if (normal.norm() < 1e-6) continue;
    normal.normalize();
    Point move = mean - p;
    move -= normal * OpenMesh::dot(move, normal);
    Point q = p + move * strength;
    for (int step = 0; step < 2; ++step) {
      const Point g = field_gradient(distance, q);
      const double d = distance({q[0], q[1], q[2]});
      if (g.sqrnorm() < 0.05) break;
      q -= g * std::clamp(d / g.sqrnorm(), -4.0, 4.0);
    }
    bool good = true;
    for (const auto face : mesh.vf_range(v)) {
      auto it = mesh.cfv_ccwbegin(face);
      Point before[3], after[3];
      for (int i = 0; i < 3; ++i, ++it) {
        before[i] = mesh.point(*it);
        after[i] = *it == v ? q : before[i];
      }
      const Point n0 = OpenMesh::cross(before[1] - before[0], before[2] - before[0]);
      const Point n1 = OpenMesh::cross(after[1] - after[0], after[2] - after[0]);
      good = good && OpenMesh::dot(n0, n1) > 0.5 * n0.norm() * n1.norm() &&
             smallest_angle(after[0], after[1], after[2]) >
                 std::min(0.15, 0.9 * smallest_angle(before[0], before[1], before[2]));
    }
    if (good) mesh.set_point(v, q);
  }
}

}  // namespace

Surface decimate_surface(const Surface& fine, int target_vertices, double max_edge, const DistanceField& distance) {
  TriMesh mesh;
  for (const auto& v : fine.vertices) mesh.add_vertex(Point(v.x(), v.y(), v.z()));
  for (const auto& t : fine.triangles)
    mesh.add_face(TriMesh::VertexHandle(t[0]), TriMesh::VertexHandle(t[1]), TriMesh::VertexHandle(t[2]));
  mesh.request_face_normals();
  mesh.update_face_normals();

  OpenMesh::Decimater::DecimaterT<TriMesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<TriMesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<TriMesh>::Handle flipping;
  ModShape<TriMesh>::Handle shape;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.add(shape);
  decimater.module(quadric).unset_max_err();
  decimater.module(flipping).set_max_normal_deviation(60);
  decimater.module(shape).set_max_edge(max_edge);
  decimater.initialize();
  decimater.decimate_to(static_cast<size_t>(target_vertices));
  mesh.garbage_collection();
  // A surface with more area or more folds than usual cannot have so few vertices that are so even.
  for (int more = 0; more < 5 && mesh.n_vertices() > 1.02 * target_vertices; ++more) {
    decimater.module(shape).set_max_edge(max_edge * (1.3 + 0.3 * more));
    decimater.module(shape).set_least_roundness(more < 2 ? 0.15 : 0.02);
    decimater.module(flipping).set_max_normal_deviation(more < 3 ? 60 : 100);
    decimater.initialize();
    decimater.decimate_to(static_cast<size_t>(target_vertices));
    mesh.garbage_collection();
  }

  for (int round = 0; round < 4; ++round) {
    flip_edges(mesh);
    relax(mesh, distance, 0.35);
  }
  flip_edges(mesh);

  Surface coarse;
  for (const auto v : mesh.vertices()) {
    const Point p = mesh.point(v);
    coarse.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto face : mesh.faces()) {
    auto it = mesh.cfv_ccwbegin(face);
    const int a = (*it).idx(), b = (*++it).idx(), c = (*++it).idx();
    coarse.triangles.emplace_back(a, b, c);
  }
  return coarse;
}

}  // namespace livecap::meshing
