#include "meshing/isosurface.h"

#include <cmath>
#include <limits>
#include <unordered_map>

namespace livecap::meshing {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kBlock = 4;  // cells per side of a block that is skipped as a whole

// The six tetrahedra of a cube around its main diagonal (Kuhn); bit 0 = +x, bit 1 = +y, bit 2 = +z. Neighbouring cubes
// agree on the diagonals of their shared faces.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

class Marcher {
 public:
  Marcher(const DistanceField& distance, const Vector3d& low, const Vector3d& high, double step)
      : distance_(distance), low_(low), step_(step) {
    for (int axis = 0; axis < 3; ++axis) {
      const int cells = static_cast<int>(std::ceil((high[axis] - low[axis]) / step));
      blocks_[axis] = (cells + kBlock - 1) / kBlock;
      nodes_[axis] = blocks_[axis] * kBlock + 1;
    }
    values_.assign(static_cast<size_t>(nodes_[0]) * nodes_[1] * nodes_[2], std::numeric_limits<float>::quiet_NaN());
  }

  Surface run() {
    const double reach = 2 * 0.5 * std::sqrt(3.0) * kBlock * step_;
    for (int z = 0; z < blocks_[2]; ++z)
      for (int y = 0; y < blocks_[1]; ++y)
        for (int x = 0; x < blocks_[0]; ++x) {
          const Vector3d center = low_ + step_ * kBlock * (Vector3d(x, y, z) + Vector3d::Constant(0.5));
          if (std::abs(distance_(center)) < reach) march_block(x * kBlock, y * kBlock, z * kBlock);
        }
    return std::move(surface_);
  }

 private:
  void march_block(int x0, int y0, int z0) {
    for (int z = z0; z < z0 + kBlock; ++z)
      for (int y = y0; y < y0 + kBlock; ++y)
        for (int x = x0; x < x0 + kBlock; ++x) march_cell(x, y, z);
  }

  void march_cell(int x, int y, int z) {
    int64_t node[8];
    float value[8];
    int inside = 0;
    for (int i = 0; i < 8; ++i) {
      const Vector3i at(x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2));
      node[i] = (static_cast<int64_t>(at[2]) * nodes_[1] + at[1]) * nodes_[0] + at[0];
      float& cached = values_[node[i]];
      if (std::isnan(cached)) cached = static_cast<float>(distance_(low_ + step_ * at.cast<double>()));
      value[i] = cached;
      inside += value[i] < 0;
    }
    if (inside == 0 || inside == 8) return;
    for (const auto& tetrahedron : kTetrahedra) march_tetrahedron(tetrahedron, {x, y, z}, node, value);
  }

  void march_tetrahedron(const int (&corners)[4], const Vector3i& cell, const int64_t (&node)[8],
                         const float (&value)[8]) {
    int in[4], out[4], n_in = 0, n_out = 0;
    for (int corner : corners) (value[corner] < 0 ? in[n_in++] : out[n_out++]) = corner;
    if (n_in == 0 || n_out == 0) return;
    const auto cut = [&](int a, int b) { return edge_vertex(a, b, cell, node, value); };
    // Outwards = from the inner corners to the outer ones.
    Vector3d outward = Vector3d::Zero();
    for (int i = 0; i < n_out; ++i) outward += corner_offset(out[i]) / n_out;
    for (int i = 0; i < n_in; ++i) outward -= corner_offset(in[i]) / n_in;
    if (n_in == 1) {
      add({cut(in[0], out[0]), cut(in[0], out[1]), cut(in[0], out[2])}, outward);
    } else if (n_out == 1) {
      add({cut(in[0], out[0]), cut(in[1], out[0]), cut(in[2], out[0])}, outward);
    } else {
      const int a = cut(in[0], out[0]), b = cut(in[0], out[1]), c = cut(in[1], out[1]), d = cut(in[1], out[0]);
      add({a, b, c}, outward);
      add({a, c, d}, outward);
    }
  }

  static Vector3d corner_offset(int i) { return Vector3d(i & 1, (i >> 1) & 1, i >> 2); }

  // The vertex where edge a-b crosses zero, kept off the ends so that no triangle collapses.
  int edge_vertex(int a, int b, const Vector3i& cell, const int64_t (&node)[8], const float (&value)[8]) {
    if (node[a] > node[b]) std::swap(a, b);
    const int64_t key = node[a] * 8 + (a ^ b);
    const auto [found, is_new] = edges_.try_emplace(key, static_cast<int>(surface_.vertices.size()));
    if (is_new) {
      const double t = std::clamp(static_cast<double>(value[a]) / (value[a] - value[b]), 0.1, 0.9);
      surface_.vertices.push_back(low_ +
                                  step_ * (cell.cast<double>() + (1 - t) * corner_offset(a) + t * corner_offset(b)));
    }
    return found->second;
  }

  void add(Vector3i triangle, const Vector3d& outward) {
    const auto& v = surface_.vertices;
    const Vector3d normal = (v[triangle[1]] - v[triangle[0]]).cross(v[triangle[2]] - v[triangle[0]]);
    if (normal.dot(outward) < 0) std::swap(triangle[1], triangle[2]);
    surface_.triangles.push_back(triangle);
  }

  const DistanceField& distance_;
  Vector3d low_;
  double step_;
  int blocks_[3];
  int nodes_[3];
  std::vector<float> values_;
  std::unordered_map<int64_t, int> edges_;
  Surface surface_;
};

}  // namespace

Surface extract_surface(const DistanceField& distance, const Vector3d& low, const Vector3d& high, double step) {
  return Marcher(distance, low, high, step).run();
}

}  // namespace livecap::meshing
