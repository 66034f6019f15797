// How fast a quantity grows: the exponent of the power law through measurements.
#pragma once

#include <cmath>
#include <limits>
#include <span>

namespace livecap {

// e of y ~ x^e: the slope of the straight line through (log x, log y) by least squares. NaN for values that are not
// positive, for fewer than two different x, and for a y missing.
inline double power_law_exponent(std::span<const double> x, std::span<const double> y) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (x.size() != y.size()) return kNone;
  const double n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0)) return kNone;
    mean_x += std::log(x[i]) / n;
    mean_y += std::log(y[i]) / n;
  }
  double spread = 0, common = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x;
    spread += dx * dx;
    common += dx * (std::log(y[i]) - mean_y);
  }
  return spread > 1e-12 ? common / spread : kNone;
}

}  // namespace livecap
