#include "meshing/remesh.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "livecap/error.h"
#include "meshing/closed_mesh.h"
#include "meshing/nearest_surface.h"
#include "meshing/surface_parts.h"

namespace livecap::meshing {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kRounds = 12;
constexpr double kRoundMm = 60;                          // a cylinder of this radius: edges of the usual length
constexpr double kAroundMm = 14;                         // curvature is a mean of so far around
constexpr double kShortest = 0.5, kLongest = 1.3;        // of the usual length
constexpr double kSplit = 4.0 / 3, kCollapse = 4.0 / 5;  // of the wanted length
constexpr double kDeepestCut = 0.15;  // of the usual length: what sticks out farther stays (fingertips, toes)
constexpr double kLeastCellMm = 4;    // of the grid that finds the nearest triangle
constexpr double kCrease = 0.15;      // share of the normals' second moment across which nothing slides

struct RemeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
  VertexTraits {
    double size = 1;  // wanted length of its edges, of the usual one
  };
};
using FineMesh = ClosedMesh<RemeshTraits>;
using Vertex = FineMesh::VertexHandle;
using Edge = FineMesh::EdgeHandle;
using Halfedge = FineMesh::HalfedgeHandle;

Vector3d eigen(const FineMesh::Point& p) {
  return {p[0], p[1], p[2]};
}

Vector3d twice_area(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (b - a).cross(c - a);
}

double smallest_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto angle = [](const Vector3d& at, const Vector3d& p, const Vector3d& q) {
    return std::atan2((p - at).cross(q - at).norm(), (p - at).dot(q - at));
  };
  return std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
}

// sqrt(k1^2 + k2^2) of the principal curvatures, 1/mm, around each vertex: of the normals as they change over the
// triangles, in the mean of rings of kAroundMm.
std::vector<double> curvature_of(const Surface& surface) {
  constexpr int kNormalRounds = 2, kMostRings = 40;
  const int rings =
      std::clamp(static_cast<int>(std::lround(kAroundMm / std::max(1e-6, mean_edge(surface)))), 1, kMostRings);
  const auto neighbors = neighbors_of(surface);
  const std::vector<Vector3d> normals = smooth_normals(surface, neighbors, kNormalRounds);
  const size_t n = surface.vertices.size();
  std::vector<double> bent(n, 0), area(n, 0);
  for (const auto& t : surface.triangles) {
    const Vector3d *p[3], *m[3];
    for (int k = 0; k < 3; ++k) p[k] = &surface.vertices[t[k]], m[k] = &normals[t[k]];
    const double twice = twice_area(*p[0], *p[1], *p[2]).norm();
    double sum = 0;  // of |grad normal|^2 over the triangle
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const double cotangent = (*p[i] - *p[k]).dot(*p[j] - *p[k]) / std::max(twice, 1e-9);
      sum += 0.5 * std::clamp(cotangent, -5.0, 5.0) * (*m[i] - *m[j]).squaredNorm();
    }
    for (int k = 0; k < 3; ++k) bent[t[k]] += std::max(0.0, sum), area[t[k]] += 0.5 * twice;
  }
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<double> next_bent = bent, next_area = area;
    for (size_t i = 0; i < n; ++i)
      for (int other : neighbors[i]) next_bent[i] += bent[other], next_area[i] += area[other];
    for (size_t i = 0; i < n; ++i) bent[i] = next_bent[i] / 7, area[i] = next_area[i] / 7;
  }
  std::vector<double> curvature(n);
  for (size_t i = 0; i < n; ++i) curvature[i] = std::sqrt(bent[i] / std::max(area[i], 1e-9));
  return curvature;
}

// The length of edges at each vertex, of the usual one: short where it is curved.
std::vector<double> sizes_of(const Surface& surface) {
  std::vector<double> sizes;
  for (const double curvature : curvature_of(surface))
    sizes.push_back(std::clamp(1 / std::sqrt(std::max(1e-9, curvature * kRoundMm)), kShortest, kLongest));
  return sizes;
}

class Remesher {
 public:
  Remesher(const Surface& fine, int target)
      : fine_(fine),
        target_(target),
        sizes_(sizes_of(fine)),
        nearest_(fine, std::max(kLeastCellMm, 2 * mean_edge(fine))) {
    for (size_t i = 0; i < fine.vertices.size(); ++i) {
      const Vector3d& p = fine.vertices[i];
      mesh_.data(mesh_.add_vertex({p.x(), p.y(), p.z()})).size = sizes_[i];
    }
    for (const auto& t : fine.triangles)
      if (!mesh_.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])).is_valid())
        throw LogicError("remesh: the surface is not manifold");
    n_vertices_ = static_cast<int>(fine.vertices.size());
    usual_ = usual_edge();
  }

  Surface run() {
    const double first = std::min(1.0, std::sqrt(double(target_) / n_vertices_) * 1.5);
    for (int round = 0; round < kRounds; ++round) {
      // Length by length: long edges collapsed at once would leave slivers.
      const double at = std::min(1.0, 2.0 * round / kRounds);
      length_ = usual_ * std::pow(first, 1 - at);
      split_long();
      collapse_short();
      if (at < 1 && n_vertices_ > 4 * target_) continue;
      flip();
      relax();
      if (at == 1) usual_ *= std::sqrt(double(n_vertices_) / target_);
    }
    length_ = usual_;
    exactly();
    for (int round = 0; round < 3; ++round) flip(), relax();
    mesh_.garbage_collection();
    Surface surface;
    for (const auto v : mesh_.vertices()) surface.vertices.push_back(at(v));
    for (const auto f : mesh_.faces()) {
      const auto corners = corners_of(f);
      surface.triangles.emplace_back(corners[0].idx(), corners[1].idx(), corners[2].idx());
    }
    return surface;
  }

 private:
  Vector3d at(Vertex v) const { return eigen(mesh_.point(v)); }
  double size(Vertex v) const { return mesh_.data(v).size; }

  std::array<Vertex, 3> corners_of(FineMesh::FaceHandle f) const {
    const Halfedge h = mesh_.halfedge_handle(f);
    const Halfedge next = mesh_.next_halfedge_handle(h);
    return {mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h), mesh_.to_vertex_handle(next)};
  }

  // Of a size of 1, for target_ vertices on the whole surface.
  double usual_edge() const {
    double units = 0;  // area by that of equilateral triangles of the wanted size; two for each vertex
    for (const auto& t : fine_.triangles) {
      const double size = (sizes_[t[0]] + sizes_[t[1]] + sizes_[t[2]]) / 3;
      units += twice_area(fine_.vertices[t[0]], fine_.vertices[t[1]], fine_.vertices[t[2]]).norm() / 2 / (size * size);
    }
    return std::sqrt(units / target_ * 2 / std::sqrt(3.0));
  }

  // The edge's length by the wanted one.
  double relative_length(Edge e) const {
    const Halfedge h = mesh_.halfedge_handle(e, 0);
    const Vertex a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
    return (at(a) - at(b)).norm() / (0.5 * length_ * (size(a) + size(b)));
  }

  void split(Edge e) {
    const Halfedge h = mesh_.halfedge_handle(e, 0);
    const Vector3d middle = 0.5 * (at(mesh_.from_vertex_handle(h)) + at(mesh_.to_vertex_handle(h)));
    const Vertex v = mesh_.add_vertex({middle.x(), middle.y(), middle.z()});
    mesh_.split(e, v);
    ++n_vertices_;
    put(v, middle);
  }

  // To the place of the fine surface nearest to p, unless that turns a triangle over: of thin cloth it may be that of
  // the other side.
  void put(Vertex v, const Vector3d& p) {
    const SurfacePoint found = nearest_.find(p);
    double size = 0;
    for (int k = 0; k < 3; ++k) size += found.weights[k] * sizes_[fine_.triangles[found.triangle][k]];
    mesh_.data(v).size = size;
    if (keeps_triangles(v, found.position))
      mesh_.set_point(v, {found.position.x(), found.position.y(), found.position.z()});
  }

  void split_long() {
    const size_t n = mesh_.n_edges();  // new ones are short enough, or wait for the next round
    for (size_t i = 0; i < n; ++i) {
      const Edge e(static_cast<int>(i));
      if (!mesh_.status(e).deleted() && relative_length(e) > kSplit) split(e);
    }
  }

  // Whether the vertex h comes from may go to where it points. loose: 1, more where too few may.
  bool may_collapse(Halfedge h, double loose) {
    if (!mesh_.is_collapse_ok(h)) return false;
    const Vertex from = mesh_.from_vertex_handle(h), to = mesh_.to_vertex_handle(h);
    const Vector3d p = at(from), q = at(to);
    double cut = 1e9;  // how far the surface will be from p
    double worst_before = 1e9, worst_after = 1e9;
    for (const auto out : mesh_.voh_range(from)) {
      const Vertex a = mesh_.to_vertex_handle(out), b = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(out));
      const Vector3d pa = at(a), pb = at(b);
      worst_before = std::min(worst_before, smallest_angle(p, pa, pb));
      if (a == to || b == to) continue;
      if ((pa - q).norm() > kSplit * loose * 0.5 * length_ * (size(a) + size(to))) return false;
      const Vector3d before = twice_area(p, pa, pb), after = twice_area(q, pa, pb);
      if (!(before.dot(after) > 0.5 * before.norm() * after.norm())) return false;
      worst_after = std::min(worst_after, smallest_angle(q, pa, pb));
      const auto w = nearest_in_triangle(p, q, pa, pb);
      cut = std::min(cut, (p - w[0] * q - w[1] * pa - w[2] * pb).norm());
    }
    return cut < kDeepestCut * loose * usual_ && worst_after > std::min(0.15, 0.5 * worst_before);
  }

  // The end that sticks out more stays.
  bool collapse(Edge e, double loose) {
    Halfedge h = mesh_.halfedge_handle(e, 0);
    if (sharpness(mesh_.from_vertex_handle(h)) > sharpness(mesh_.to_vertex_handle(h)))
      h = mesh_.opposite_halfedge_handle(h);
    if (!may_collapse(h, loose)) {
      h = mesh_.opposite_halfedge_handle(h);
      if (!may_collapse(h, loose)) return false;
    }
    mesh_.collapse(h);
    --n_vertices_;
    return true;
  }

  void collapse_short() {
    const size_t n = mesh_.n_edges();
    for (size_t i = 0; i < n; ++i) {
      const Edge e(static_cast<int>(i));
      if (!mesh_.status(e).deleted() && relative_length(e) < kCollapse) collapse(e, 1);
    }
    mesh_.garbage_collection();
  }

  // Second moment of the normals around a vertex, trace 1: its eigenvectors other than that of the largest eigenvalue
  // are the directions across and along creases.
  Matrix3d moment(Vertex v) const {
    Matrix3d sum = Matrix3d::Zero();
    for (const auto f : mesh_.vf_range(v)) {
      const auto c = corners_of(f);
      const Vector3d normal = twice_area(at(c[0]), at(c[1]), at(c[2]));
      if (const double norm = normal.norm(); norm > 1e-12) sum += normal * normal.transpose() / norm;
    }
    const double trace = sum.trace();
    return trace > 0 ? Matrix3d(sum / trace) : sum;
  }

  // 0 where it is flat, 2/3 at a corner.
  double sharpness(Vertex v) const { return 1 - moment(v).squaredNorm(); }

  // Turns edges whose two triangles get a better smallest angle that way, unless that makes a sharper crease.
  void flip() {
    for (const auto e : mesh_.edges()) {
      if (!mesh_.is_flip_ok(e)) continue;
      const Halfedge h = mesh_.halfedge_handle(e, 0), o = mesh_.opposite_halfedge_handle(h);
      const Vector3d a = at(mesh_.from_vertex_handle(h)), b = at(mesh_.to_vertex_handle(h));
      const Vector3d c = at(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
      const Vector3d d = at(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o)));
      const Vector3d n0 = twice_area(a, b, c).normalized(), n1 = twice_area(b, a, d).normalized();
      const Vector3d m0 = twice_area(a, d, c).normalized(), m1 = twice_area(d, b, c).normalized();
      const double flat_before = n0.dot(n1), flat_after = m0.dot(m1);
      if (!(flat_after > std::min(flat_before, 0.94)) || !(m0.dot(n0 + n1) > 0) || !(m1.dot(n0 + n1) > 0)) continue;
      const double before = std::min(smallest_angle(a, b, c), smallest_angle(a, d, b));
      const double after = std::min(smallest_angle(c, d, b), smallest_angle(c, a, d));
      if (after > before + 0.02) mesh_.flip(e);
    }
  }

  // Moves each vertex towards the middle of its triangles, along the surface and along creases only. A move that turns
  // a triangle over is undone.
  void relax() {
    for (const auto v : mesh_.vertices()) {
      const Vector3d p = at(v);
      Vector3d middle = Vector3d::Zero();
      double weight = 0;
      for (const auto f : mesh_.vf_range(v)) {
        const auto c = corners_of(f);
        const double s = (size(c[0]) + size(c[1]) + size(c[2])) / 3;
        const double w = twice_area(at(c[0]), at(c[1]), at(c[2])).norm() / (s * s);
        middle += w / 3 * (at(c[0]) + at(c[1]) + at(c[2]));
        weight += w;
      }
      if (!(weight > 0)) continue;
      Vector3d move = middle / weight - p;
      const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(moment(v));
      for (int k = 0; k < 3; ++k)
        if (k == 2 || axes.eigenvalues()[k] > kCrease)
          move -= axes.eigenvectors().col(k) * axes.eigenvectors().col(k).dot(move);
      put(v, p + move);
    }
  }

  bool keeps_triangles(Vertex v, const Vector3d& q) const {
    for (const auto f : mesh_.vf_range(v)) {
      const auto c = corners_of(f);
      Vector3d before[3], after[3];
      for (int k = 0; k < 3; ++k) before[k] = at(c[k]), after[k] = c[k] == v ? q : before[k];
      const Vector3d n0 = twice_area(before[0], before[1], before[2]), n1 = twice_area(after[0], after[1], after[2]);
      if (!(n0.dot(n1) > 0.5 * n0.norm() * n1.norm())) return false;
      if (!(smallest_angle(after[0], after[1], after[2]) >
            std::min(0.3, 0.9 * smallest_angle(before[0], before[1], before[2]))))
        return false;
    }
    return true;
  }

  // Collapses the shortest edges, or splits the longest ones, until the number is right.
  void exactly() {
    for (int round = 0; round < 20 && n_vertices_ != target_; ++round) {
      std::vector<std::pair<double, Edge>> edges;
      for (const auto e : mesh_.edges()) edges.emplace_back(relative_length(e), e);
      std::sort(edges.begin(), edges.end());
      if (n_vertices_ > target_) {
        for (const auto& [length, e] : edges)
          if (n_vertices_ > target_ && !mesh_.status(e).deleted()) collapse(e, 1 + 0.2 * round);
        mesh_.garbage_collection();
      } else {
        for (auto it = edges.rbegin(); it != edges.rend() && n_vertices_ < target_; ++it) split(it->second);
      }
    }
  }

  const Surface& fine_;
  int target_;
  std::vector<double> sizes_;  // of the fine surface's vertices
  NearestSurface nearest_;
  FineMesh mesh_;
  int n_vertices_ = 0;
  double usual_ = 0, length_ = 0;  // mm, of a size of 1: in the end, and in this round
};

}  // namespace

Surface remesh(const Surface& fine, int target_vertices) {
  if (target_vertices < 4) throw LogicError("remesh to " + std::to_string(target_vertices) + " vertices");
  if (static_cast<int>(fine.vertices.size()) <= target_vertices) return fine;
  return Remesher(fine, target_vertices).run();
}

}  // namespace livecap::meshing
