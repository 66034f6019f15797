#include "detect/one_euro.h"

#include <cmath>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::detect {
namespace {

// Weight of the new value in an exponential low-pass of this cut-off.
double smoothing(double cutoff_hz, double dt_s) {
  const double tau = 1.0 / (2.0 * M_PI * cutoff_hz);
  return 1.0 / (1.0 + tau / dt_s);
}

}  // namespace

void OneEuroOptions::validate() const {
  const bool finite = std::isfinite(min_cutoff_hz) && std::isfinite(beta) && std::isfinite(derivative_cutoff_hz);
  if (!finite || min_cutoff_hz <= 0 || derivative_cutoff_hz <= 0 || beta < 0)
    throw ConfigError(
        format("1 euro filter: min_cutoff %g Hz and derivative_cutoff %g Hz must be positive, beta %g not negative",
               min_cutoff_hz, derivative_cutoff_hz, beta));
}

double OneEuroFilter::filter(const OneEuroOptions& options, double value, double dt_s, double scale) {
  if (!started_) {
    started_ = true;
    raw_ = value_ = value;
    speed_ = 0;
    return value;
  }
  const double speed = (value - raw_) * scale / dt_s;
  speed_ += smoothing(options.derivative_cutoff_hz, dt_s) * (speed - speed_);
  const double cutoff = options.min_cutoff_hz + options.beta * std::abs(speed_);
  value_ += smoothing(cutoff, dt_s) * (value - value_);
  raw_ = value;
  return value_;
}

}  // namespace livecap::detect
