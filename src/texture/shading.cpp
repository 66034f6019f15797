#include "texture/shading.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/luminance.h"
#include "geometry/reference.h"
#include "meshing/surface_parts.h"

namespace livecap {

namespace {

using Eigen::Vector3d;
using Basis = Eigen::Vector<double, 8>;

constexpr double kDarkest = 0.02;  // of 1; below it a logarithm is noise
constexpr double kMostLog = 0.69;  // a factor of two
constexpr double kLeastScale = 0.01;
constexpr size_t kFewestPairs = 200;
constexpr int kRounds = 10;

// All but the constant.
Basis basis_at(const Vector3d& n) {
  const reference::Harmonics h = reference::harmonics(reference::vec3(n.x(), n.y(), n.z()));
  return Basis(h.of + 1);
}

double log_light(const Vector3d& color) {
  return std::log(std::max(kDarkest, color.dot(Vector3d(kRedLuminance, kGreenLuminance, kBlueLuminance))));
}

}  // namespace

double Shading::at(const Vector3d& normal) const {
  return std::exp(std::clamp(coefficients.dot(basis_at(normal)) - mean_log, -kMostLog, kMostLog));
}

Shading find_shading(const meshing::Surface& surface, const std::vector<Vector3d>& colors,
                     const std::vector<char>& known) {
  const std::vector<Vector3d> normals = meshing::vertex_normals(surface);
  std::vector<std::pair<Basis, double>> pairs;  // differences of basis and brightness along an edge
  for (const auto& t : surface.triangles)
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3];
      if (known[i] && known[j])
        pairs.emplace_back(basis_at(normals[j]) - basis_at(normals[i]), log_light(colors[j]) - log_light(colors[i]));
    }
  Shading shading;
  if (pairs.size() < kFewestPairs) return shading;
  std::vector<double> sizes(pairs.size());
  for (int round = 0; round < kRounds; ++round) {
    const auto residual = [&](size_t p) { return pairs[p].second - shading.coefficients.dot(pairs[p].first); };
    for (size_t p = 0; p < pairs.size(); ++p) sizes[p] = std::abs(residual(p));
    std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
    const double scale = std::max(kLeastScale, 1.4826 * sizes[sizes.size() / 2]);
    Eigen::Matrix<double, 8, 8> normal_matrix = 1e-3 * Eigen::Matrix<double, 8, 8>::Identity();
    Basis right = Basis::Zero();
    for (size_t p = 0; p < pairs.size(); ++p) {
      const double share = residual(p) / scale, weight = 1 / (1 + share * share);
      normal_matrix += weight * pairs[p].first * pairs[p].first.transpose();
      right += weight * pairs[p].second * pairs[p].first;
    }
    shading.coefficients = normal_matrix.ldlt().solve(right);
  }
  double sum = 0, area = 0;
  for (const auto& t : surface.triangles) {
    const double a =
        (surface.vertices[t[1]] - surface.vertices[t[0]]).cross(surface.vertices[t[2]] - surface.vertices[t[0]]).norm();
    for (int k = 0; k < 3; ++k) sum += a * shading.coefficients.dot(basis_at(normals[t[k]]));
    area += 3 * a;
  }
  if (area > 0) shading.mean_log = sum / area;
  return shading;
}

}  // namespace livecap
