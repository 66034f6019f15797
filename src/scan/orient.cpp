#include "scan/orient.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace livecap {

namespace {

using Eigen::Vector3d;

// Open patches that enclose less than this share of what closed ones do are sheets: which side is theirs is not known.
constexpr double kSheets = 0.1;

struct Edge {
  int low, high, triangle;
  bool upwards;  // the triangle runs from low to high
};

struct Neighbor {
  int triangle = -1;  // -1: the edge has not two triangles
  bool same_way = false;
};

// Across the three edges of each triangle.
std::vector<std::array<Neighbor, 3>> neighbors_of(const std::vector<Eigen::Vector3i>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  std::vector<std::array<Neighbor, 3>> neighbors(triangles.size());
  const auto slot = [&](const Edge& edge) -> Neighbor& {
    const Eigen::Vector3i& t = triangles[edge.triangle];
    int k = 0;
    while (std::min(t[k], t[(k + 1) % 3]) != edge.low || std::max(t[k], t[(k + 1) % 3]) != edge.high) ++k;
    return neighbors[edge.triangle][k];
  };
  for (size_t i = 0; i < edges.size();) {
    size_t end = i;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end - i == 2) {
      const bool same_way = edges[i].upwards == edges[i + 1].upwards;
      slot(edges[i]) = {edges[i + 1].triangle, same_way};
      slot(edges[i + 1]) = {edges[i].triangle, same_way};
    }
    i = end;
  }
  return neighbors;
}

class Orienter {
 public:
  explicit Orienter(const meshing::Surface& surface)
      : surface_(surface), turned_(surface.triangles.size(), 0), seen_(surface.triangles.size(), 0) {
    for (const Vector3d& p : surface.vertices) middle_ += p / static_cast<double>(surface.vertices.size());
  }

  // [n_triangles] 1: to be turned.
  std::vector<char> run() {
    neighbors_ = neighbors_of(surface_.triangles);
    std::vector<int> open;
    double open_volume = 0, closed_volume = 0;
    for (size_t t = 0; t < seen_.size(); ++t) {
      if (seen_[t]) continue;
      const bool closed = take_patch(static_cast<int>(t));
      double volume = 0;
      for (const int i : patch_) volume += sign(i) * volume_of_cone(i);
      if (closed) {
        if (volume < 0) turn(patch_);
        closed_volume += std::abs(volume);
      } else {
        open.insert(open.end(), patch_.begin(), patch_.end());
        open_volume += volume;
      }
    }
    if (open_volume < -kSheets * closed_volume) turn(open);
    return std::move(turned_);
  }

 private:
  double sign(int t) const { return turned_[t] ? -1 : 1; }
  const Vector3d& corner(int t, int k) const { return surface_.vertices[surface_.triangles[t][k]]; }
  double area_of(int t) const { return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm(); }
  double volume_of_cone(int t) const {
    return (corner(t, 0) - middle_).dot((corner(t, 1) - middle_).cross(corner(t, 2) - middle_));
  }
  void turn(const std::vector<int>& triangles) {
    for (const int t : triangles) turned_[t] = !turned_[t];
  }

  // The patch of `first`, turned to one side. True when it is closed, and has two sides.
  bool take_patch(int first) {
    bool closed = true;
    double area = 0;  // as in the file, minus turned
    patch_ = {first};
    seen_[first] = 1;
    for (size_t next = 0; next < patch_.size(); ++next) {
      const int t = patch_[next];
      area += sign(t) * area_of(t);
      for (const Neighbor& other : neighbors_[t]) {
        if (other.triangle < 0) {
          closed = false;
          continue;
        }
        const char turned = static_cast<char>(turned_[t] != other.same_way);
        if (seen_[other.triangle]) {
          closed = closed && turned_[other.triangle] == turned;
          continue;
        }
        seen_[other.triangle] = 1;
        turned_[other.triangle] = turned;
        patch_.push_back(other.triangle);
      }
    }
    if (area < 0) turn(patch_);
    return closed;
  }

  const meshing::Surface& surface_;
  Vector3d middle_ = Vector3d::Zero();
  std::vector<std::array<Neighbor, 3>> neighbors_;
  std::vector<char> turned_, seen_;
  std::vector<int> patch_;
};

}  // namespace

size_t orient(meshing::Surface& surface, std::vector<Eigen::Vector2d>& uvs) {
  const std::vector<char> turned = Orienter(surface).run();
  for (size_t t = 0; t < turned.size(); ++t) {
    if (!turned[t]) continue;
    std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    if (!uvs.empty()) std::swap(uvs[3 * t + 1], uvs[3 * t + 2]);
  }
  return static_cast<size_t>(std::count(turned.begin(), turned.end(), 1));
}

}  // namespace livecap
