#include "texture/shading.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "base/luminance.h"
#include "base/median.h"
#include "geometry/reference.h"
#include "meshing/surface_parts.h"

namespace livecap {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Basis = Eigen::Vector<double, Shading::kTerms>;

constexpr double kDarkest = 0.02;  // of 1; below it a logarithm is noise
constexpr double kMostLog = 0.69;  // a factor of two
constexpr double kLeastScale = 0.01;
constexpr size_t kFewestPairs = 200;
constexpr int kRounds = 6;        // with the first two orders, and as many with all
constexpr int kTermsToBegin = 8;  // of the first two orders
constexpr int kSmoothings = 2;
constexpr int kPartners = 60;          // drawn for every vertex
constexpr double kSameChroma = 0.06;   // of red and blue by the mean of the three
constexpr double kNoMaterial = 0.013;  // added to the mean, in [0,1]: what dark pixels tell of their colour is noise

// Spherical harmonics of orders 1, 2 and 3, not scaled.
Basis basis_at(const Vector3d& n) {
  const reference::Harmonics h = reference::harmonics(reference::vec3(n.x(), n.y(), n.z()));
  const double x = n.x(), y = n.y(), z = n.z(), xx = x * x, yy = y * y, zz = z * z;
  Basis basis;
  basis.head<kTermsToBegin>() = Eigen::Vector<double, kTermsToBegin>(h.of + 1);
  basis.tail<Shading::kTerms - kTermsToBegin>() << x * y * z, x * (xx - 3 * yy), y * (3 * xx - yy), z * (xx - yy),
      x * (5 * zz - 1), y * (5 * zz - 1), z * (5 * zz - 3);
  return basis;
}

double log_light(const Vector3d& color) {
  return std::log(std::max(kDarkest, color.dot(Vector3d(kRedLuminance, kGreenLuminance, kBlueLuminance))));
}

// Red and blue by the mean of the three.
Vector2d chroma(const Vector3d& color) {
  return Vector2d(color.x(), color.z()) / (color.mean() + kNoMaterial);
}

// Basis and logarithm of the light: how they differ between two vertices.
struct Pair {
  Basis basis;
  double light;
};

std::vector<Pair> pairs_of_one_color(const std::vector<Vector3d>& normals, const std::vector<Vector3d>& colors,
                                     const std::vector<char>& known) {
  std::vector<Vector2d> chromas;
  for (const Vector3d& color : colors) chromas.push_back(chroma(color));
  std::vector<Pair> pairs;
  std::mt19937 random(1);
  for (size_t i = 0; i < normals.size(); ++i)
    for (int k = 0; k < kPartners; ++k) {
      const size_t j = random() % normals.size();
      if (!known[i] || !known[j] || (chromas[j] - chromas[i]).norm() > kSameChroma) continue;
      const double light = log_light(colors[j]) - log_light(colors[i]);
      pairs.push_back({basis_at(normals[j]) - basis_at(normals[i]), light});
    }
  return pairs;
}

}  // namespace

std::vector<Vector3d> shading_normals(const meshing::Surface& surface) {
  return meshing::smooth_normals(surface, meshing::neighbors_of(surface), kSmoothings);
}

double Shading::at(const Vector3d& normal) const {
  return std::exp(std::clamp(coefficients.dot(basis_at(normal)) - mean_log, -kMostLog, kMostLog));
}

Shading find_shading(const meshing::Surface& surface, const std::vector<Vector3d>& colors,
                     const std::vector<char>& known) {
  const std::vector<Vector3d> normals = shading_normals(surface);
  const std::vector<Pair> pairs = pairs_of_one_color(normals, colors, known);
  Shading shading;
  if (pairs.size() < kFewestPairs) return shading;
  std::vector<double> sizes(pairs.size());
  for (int round = 0; round < 2 * kRounds; ++round) {
    // A pattern would be taken for light of the third order, were it not known by then to be none.
    const int n = round < kRounds ? kTermsToBegin : Shading::kTerms;
    const auto residual = [&](size_t p) { return pairs[p].light - shading.coefficients.dot(pairs[p].basis); };
    for (size_t p = 0; p < pairs.size(); ++p) sizes[p] = std::abs(residual(p));
    const double scale = std::max(kLeastScale, 1.4826 * median(sizes));
    Eigen::Matrix<double, Shading::kTerms, Shading::kTerms> normal_matrix;
    normal_matrix.setIdentity();
    normal_matrix *= 1e-3;
    Basis right = Basis::Zero();
    for (size_t p = 0; p < pairs.size(); ++p) {
      const double share = residual(p) / scale, weight = 1 / (1 + share * share);
      normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(pairs[p].basis, weight);
      right += weight * pairs[p].light * pairs[p].basis;
    }
    shading.coefficients.head(n) =
        normal_matrix.topLeftCorner(n, n).selfadjointView<Eigen::Lower>().ldlt().solve(right.head(n));
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
