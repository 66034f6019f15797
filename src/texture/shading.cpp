#include "texture/shading.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "base/srgb.h"
#include "meshing/surface_parts.h"
#include "texture/nonnegative_least_squares.h"

namespace livecap {

namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kDarkest = 0.002;     // of 1, linear; below it a logarithm is noise
constexpr double kMostLight = 5;       // by the mean, and as much less
constexpr double kDarkestSide = 0.05;  // of the mean light, while it is sought
// Of sizes of residuals the third from below, in standard deviations of a normal distribution; the median would be of
// pairs of two materials where two patterns cover the same.
constexpr double kDeviationsOfThird = 2.32;
constexpr double kLeastScale = 0.02;
constexpr size_t kFewestPairs = 200;
constexpr int kRounds = 8;
// How much lamps want to be equal, of their mean curvature: much at first, so that patterns are known to be none by the
// time that light could look like them.
constexpr double kEvenFirst = 0.03, kEvenLast = 1e-4;
constexpr int kSmoothings = 1;
constexpr size_t kPartners = 60;  // drawn for every vertex
constexpr size_t kMostPairs = 20000;
constexpr double kSameChroma = 0.06;   // of red and blue by the mean of the three
constexpr double kNoMaterial = 0.013;  // added to the mean, in [0,1]: what dark pixels tell of their colour is noise
constexpr int kBlock = 512;            // pairs whose equations are added at once

// Evenly spread over the sphere, [lamps,3]: a spiral.
const Eigen::Matrix<double, Shading::kLamps, 3>& lamps() {
  static const Eigen::Matrix<double, Shading::kLamps, 3> directions = [] {
    Eigen::Matrix<double, Shading::kLamps, 3> all;
    const double golden_angle = M_PI * (3 - std::sqrt(5.0));
    for (int k = 0; k < Shading::kLamps; ++k) {
      const double y = 1 - (2 * k + 1.0) / Shading::kLamps, r = std::sqrt(1 - y * y), angle = golden_angle * k;
      all.row(k) << r * std::cos(angle), y, r * std::sin(angle);
    }
    return all;
  }();
  return directions;
}

// Red and blue by the mean of the three.
Vector2d chroma(const Vector3d& color) {
  return Vector2d(color.x(), color.z()) / (color.mean() + kNoMaterial);
}

using Pairs = std::vector<std::pair<int, int>>;

Pairs pairs_of_one_color(const std::vector<Vector3d>& colors, const std::vector<char>& known) {
  std::vector<Vector2d> chromas;
  for (const Vector3d& color : colors) chromas.push_back(chroma(color));
  Pairs pairs;
  std::mt19937 random(1);
  for (size_t draw = 0; draw < kPartners * colors.size() && pairs.size() < kMostPairs; ++draw) {
    const size_t i = random() % colors.size(), j = random() % colors.size();
    if (!known[i] || !known[j] || i == j || (chromas[j] - chromas[i]).norm() > kSameChroma) continue;
    pairs.emplace_back(static_cast<int>(i), static_cast<int>(j));
  }
  return pairs;
}

// Powers of the lamps of one channel. falling: [n,lamps], what each vertex gets of each lamp; mean: [lamps], of all
// that was seen; seen: [n], linear.
VectorXd find_powers(const MatrixXd& falling, const VectorXd& mean, const VectorXd& seen, const Pairs& pairs) {
  const VectorXd even = VectorXd::Constant(falling.cols(), 1 / mean.sum());
  VectorXd powers = even;
  std::vector<double> residuals(pairs.size()), sizes(pairs.size());
  MatrixXd block(kBlock, falling.cols());
  for (int round = 0; round < kRounds; ++round) {
    const VectorXd light = (falling * powers).cwiseMax(kDarkestSide);
    for (size_t p = 0; p < pairs.size(); ++p) {
      const auto [i, j] = pairs[p];
      residuals[p] = std::log(seen[j] * light[i] / (seen[i] * light[j]));
      sizes[p] = std::abs(residuals[p]);
    }
    const auto third = sizes.begin() + static_cast<int>(sizes.size() / 3);
    std::nth_element(sizes.begin(), third, sizes.end());
    const double scale = std::max(kLeastScale, kDeviationsOfThird * *third);
    // The albedos are equal: seen_j light_i = seen_i light_j, by their geometric mean as different as the logarithms.
    MatrixXd normal_matrix = MatrixXd::Zero(falling.cols(), falling.cols());
    int n_rows = 0;
    for (size_t p = 0; p < pairs.size(); ++p) {
      const auto [i, j] = pairs[p];
      const double share = residuals[p] / scale;
      const double weight = std::sqrt(1 / ((1 + share * share) * seen[i] * seen[j] * light[i] * light[j]));
      block.row(n_rows++) = weight * (seen[j] * falling.row(i) - seen[i] * falling.row(j));
      if (n_rows < kBlock && p + 1 < pairs.size()) continue;
      normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(block.topRows(n_rows).transpose());
      n_rows = 0;
    }
    normal_matrix.triangularView<Eigen::StrictlyUpper>() = normal_matrix.transpose();
    normal_matrix /= std::max(1e-12, normal_matrix.trace() / static_cast<double>(falling.cols()));
    const double to_even = kEvenFirst * std::pow(kEvenLast / kEvenFirst, round / (kRounds - 1.0));
    normal_matrix.diagonal().array() += to_even;
    normal_matrix += mean * mean.transpose();  // the mean light is 1
    powers = solve_nonnegative(normal_matrix, mean + to_even * even);
    powers /= std::max(1e-12, mean.dot(powers));
  }
  return powers;
}

}  // namespace

std::vector<Vector3d> shading_normals(const meshing::Surface& surface) {
  return meshing::smooth_normals(surface, meshing::neighbors_of(surface), kSmoothings);
}

Eigen::Array3d Shading::at(const Vector3d& normal) const {
  if (!found) return Eigen::Array3d::Ones();
  const Eigen::Matrix<double, kLamps, 1> falling = (lamps() * normal).cwiseMax(0);
  return (powers.transpose() * falling).array().max(1 / kMostLight).min(kMostLight);
}

Vector3d without_light(const Vector3d& color, const Eigen::Array3d& light) {
  Vector3d result;
  for (int c = 0; c < 3; ++c) result[c] = srgb_from_linear(std::min(1.0, linear_from_srgb(color[c]) / light[c]));
  return result;
}

Shading find_shading(const meshing::Surface& surface, const std::vector<Vector3d>& normals,
                     const std::vector<Vector3d>& colors, const std::vector<char>& known) {
  const Pairs pairs = pairs_of_one_color(colors, known);
  Shading shading;
  if (pairs.size() < kFewestPairs) return shading;
  const auto n = static_cast<Eigen::Index>(normals.size());
  MatrixXd falling(n, Shading::kLamps);
  for (Eigen::Index i = 0; i < n; ++i) falling.row(i) = (lamps() * normals[i]).cwiseMax(0);
  VectorXd area = VectorXd::Zero(n);  // of what was seen
  for (const auto& t : surface.triangles)
    for (int k : t)
      if (known[k])
        area[k] += (surface.vertices[t[1]] - surface.vertices[t[0]])
                       .cross(surface.vertices[t[2]] - surface.vertices[t[0]])
                       .norm();
  area /= area.sum();
  const VectorXd mean = falling.transpose() * area;
  for (int c = 0; c < 3; ++c) {
    VectorXd seen(n);
    for (Eigen::Index i = 0; i < n; ++i) seen[i] = std::max(kDarkest, linear_from_srgb(colors[i][c]));
    shading.powers.col(c) = find_powers(falling, mean, seen, pairs);
  }
  shading.found = true;
  return shading;
}

}  // namespace livecap
