#include "acquire/facet_offsets.h"

#include <algorithm>
#include <cmath>

#include "meshing/surface_parts.h"

namespace livecap::acquire {

using Eigen::Vector3d;

std::vector<double> mean_offsets(const meshing::Surface& surface, int rounds, double most_mm,
                                 const OutsideMm& outside) {
  constexpr int kParts = 4;  // of an edge: points of a triangle are the middles of the parts that stand as it does
  const std::vector<Vector3d> normals = meshing::vertex_normals(surface);
  const size_t n = surface.vertices.size();
  std::vector<double> offsets(n, 0), sum(n), weight(n);
  for (int round = 0; round < rounds; ++round) {
    std::fill(sum.begin(), sum.end(), 0);
    std::fill(weight.begin(), weight.end(), 0);
    for (const auto& t : surface.triangles) {
      Vector3d corners[3];
      for (int k = 0; k < 3; ++k) corners[k] = surface.vertices[t[k]] + offsets[t[k]] * normals[t[k]];
      const double area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm();
      for (int i = 0; i < kParts; ++i)
        for (int j = 0; i + j < kParts; ++j) {
          const double b1 = (i + 1.0 / 3) / kParts, b2 = (j + 1.0 / 3) / kParts, share[3] = {1 - b1 - b2, b1, b2};
          const Vector3d normal = share[0] * normals[t[0]] + b1 * normals[t[1]] + b2 * normals[t[2]];
          const double mm = outside(share[0] * corners[0] + b1 * corners[1] + b2 * corners[2], normal.normalized());
          if (std::isnan(mm)) continue;
          for (int k = 0; k < 3; ++k) {
            sum[t[k]] -= share[k] * area * mm;
            weight[t[k]] += share[k] * area;
          }
        }
    }
    for (size_t i = 0; i < n; ++i)
      if (weight[i] > 0) offsets[i] = std::clamp(offsets[i] + sum[i] / weight[i], -most_mm, most_mm);
  }
  return offsets;
}

std::vector<double> facet_offsets(const meshing::Surface& surface, const Volume& volume) {
  constexpr int kRounds = 3;  // more would follow the noise of the triangles
  const double most = 0.25 * meshing::mean_edge(surface);
  return mean_offsets(surface, kRounds, most, [&](const Vector3d& p, const Vector3d&) { return volume.at(p); });
}

double ramp_above(double lowest_mm, const Vector3d& p) {
  constexpr double kRampMm = 20;
  return std::clamp((p.y() - lowest_mm) / kRampMm, 0.0, 1.0);
}

void move_along_normals(const std::vector<double>& offsets_mm, meshing::Surface& surface) {
  const std::vector<Vector3d> normals = meshing::vertex_normals(surface);
  for (size_t i = 0; i < offsets_mm.size(); ++i) surface.vertices[i] += offsets_mm[i] * normals[i];
}

}  // namespace livecap::acquire
