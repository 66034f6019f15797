#include "scan/mesh_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "livecap/error.h"
#include "meshing/nearest_surface.h"

namespace livecap {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kBandSteps = 2;

struct Crossing {
  float at;    // along the axis, steps
  int8_t way;  // +1: the ray enters, -1: it leaves
};

// For one axis: adds to votes[node] 1 for each of the two directions that says inside.
void vote(const meshing::Surface& surface, const Volume& volume, int axis, std::vector<uint8_t>& votes) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int counts[3] = {volume.nx, volume.ny, volume.nz};
  const size_t strides[3] = {1, static_cast<size_t>(volume.nx), static_cast<size_t>(volume.nx) * volume.ny};
  std::vector<std::vector<Crossing>> columns(static_cast<size_t>(counts[u]) * counts[v]);
  // A little off the nodes, so that no ray meets an edge or corner of a mesh on round numbers.
  const double shift_u = 1.3e-4, shift_v = 2.9e-4;
  for (const auto& t : surface.triangles) {
    Vector3d p[3];
    for (int k = 0; k < 3; ++k) p[k] = (surface.vertices[t[k]] - volume.low) / volume.step;
    const double area = (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
    if (area == 0) continue;
    const auto [u0, u1] = std::minmax({p[0][u], p[1][u], p[2][u]});
    const auto [v0, v1] = std::minmax({p[0][v], p[1][v], p[2][v]});
    for (int j = std::max(0, static_cast<int>(std::ceil(v0 - shift_v))); j <= v1 - shift_v && j < counts[v]; ++j)
      for (int i = std::max(0, static_cast<int>(std::ceil(u0 - shift_u))); i <= u1 - shift_u && i < counts[u]; ++i) {
        const double x = i + shift_u, y = j + shift_v;
        const double w1 = ((x - p[0][u]) * (p[2][v] - p[0][v]) - (y - p[0][v]) * (p[2][u] - p[0][u])) / area;
        const double w2 = ((p[1][u] - p[0][u]) * (y - p[0][v]) - (p[1][v] - p[0][v]) * (x - p[0][u])) / area;
        if (w1 < 0 || w2 < 0 || w1 + w2 > 1) continue;
        const double at = p[0][axis] + w1 * (p[1][axis] - p[0][axis]) + w2 * (p[2][axis] - p[0][axis]);
        columns[static_cast<size_t>(j) * counts[u] + i].push_back(
            {static_cast<float>(at), static_cast<int8_t>(area > 0 ? -1 : 1)});
      }
  }
  for (int j = 0; j < counts[v]; ++j)
    for (int i = 0; i < counts[u]; ++i) {
      auto& column = columns[static_cast<size_t>(j) * counts[u] + i];
      std::sort(column.begin(), column.end(), [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
      int total = 0;
      for (const Crossing& c : column) total += c.way;
      int winding = 0;
      size_t next = 0;
      for (int k = 0; k < counts[axis]; ++k) {
        for (; next < column.size() && column[next].at < k; ++next) winding += column[next].way;
        uint8_t& votes_here = votes[i * strides[u] + j * strides[v] + k * strides[axis]];
        votes_here = static_cast<uint8_t>(votes_here + (winding > 0) + (winding - total > 0));
      }
    }
}

}  // namespace

Volume volume_of(const meshing::Surface& surface, double step_mm) {
  if (surface.triangles.empty()) throw ConfigError("the mesh has no triangles");
  Vector3d low = Vector3d::Constant(1e300), high = -low;
  for (const Vector3d& p : surface.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vector3d margin = Vector3d::Constant(4 * step_mm);
  Volume volume = make_volume(low - margin, high + margin, step_mm);
  const float band = static_cast<float>(kBandSteps * step_mm);
  std::vector<float> nearest(volume.size(), band);
  for (const auto& t : surface.triangles) {
    const Vector3d &a = surface.vertices[t[0]], &b = surface.vertices[t[1]], &c = surface.vertices[t[2]];
    const Vector3d from = (a.cwiseMin(b).cwiseMin(c) - volume.low) / step_mm - Vector3d::Constant(kBandSteps);
    const Vector3d to = (a.cwiseMax(b).cwiseMax(c) - volume.low) / step_mm + Vector3d::Constant(kBandSteps);
    const Vector3i i0 = from.array().ceil().cast<int>().max(0);
    const Vector3i i1 = to.array().floor().cast<int>().min(Eigen::Array3i(volume.nx, volume.ny, volume.nz) - 1);
    const Vector3d normal = (b - a).cross(c - a).normalized();
    for (int z = i0.z(); z <= i1.z(); ++z)
      for (int y = i0.y(); y <= i1.y(); ++y)
        for (int x = i0.x(); x <= i1.x(); ++x) {
          const Vector3d p = volume.low + step_mm * Vector3d(x, y, z);
          float& d = nearest[volume.index(x, y, z)];
          if (std::abs(normal.dot(p - a)) >= d) continue;
          const auto w = meshing::nearest_in_triangle(p, a, b, c);
          d = std::min(d, static_cast<float>((w[0] * a + w[1] * b + w[2] * c - p).norm()));
        }
  }
  std::vector<uint8_t> votes(volume.size(), 0);
  for (int axis = 0; axis < 3; ++axis) vote(surface, volume, axis, votes);
  for (size_t i = 0; i < votes.size(); ++i) volume.distance[i] = votes[i] >= 4 ? -nearest[i] : nearest[i];
  return volume;
}

}  // namespace livecap
