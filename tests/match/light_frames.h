// Surfaces of all directions that a camera sees, in a light that is known.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "match/harmonic_light.h"

namespace livecap::test {

// A bright sky and a sun from the upper left in front, without their shadows: linear and quadratic in n.
inline double brightness(const Eigen::Vector3d& n) {
  const double sun = n.dot(Eigen::Vector3d(-0.3, -0.6, -0.5));
  return 0.6 - 0.2 * n.y() + 0.4 * sun + 0.3 * sun * sun;
}

struct Lit {
  Eigen::Vector3f normal;  // towards -z
  float brightness;
};

inline std::vector<Lit> light_frame(std::mt19937& rng, int n, double noise, double share_in_shadow) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Lit> lit;
  while (int(lit.size()) < n) {
    const Eigen::Vector3d v = Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
    if (v.z() > -0.3) continue;
    const double shadow = uniform(rng) < share_in_shadow ? 0.3 : 1;
    lit.push_back({v.cast<float>(), float(shadow * brightness(v) + noise * normal(rng))});
  }
  return lit;
}

inline double largest_error(const HarmonicLight& light) {
  std::mt19937 rng(99);
  double worst = 0;
  for (const Lit& l : light_frame(rng, 200, 0, 0)) {
    const Eigen::Vector3d n = l.normal.cast<double>();
    worst = std::max(worst, std::abs(light.residual(n, brightness(n))) * light.deviation());
  }
  return worst;
}

}  // namespace livecap::test
