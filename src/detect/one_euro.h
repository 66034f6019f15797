// The 1 euro filter (Casiez, Roussel, Vogel 2012): a low-pass whose cut-off rises with speed, so that a resting value
// is smooth and a fast one does not lag.
#pragma once

namespace livecap::detect {

struct OneEuroOptions {
  double min_cutoff_hz = 1.0;         // cut-off at rest
  double beta = 0.0;                  // Hz of cut-off per unit of speed (scaled values per second)
  double derivative_cutoff_hz = 1.0;  // cut-off of the speed estimate

  // Throws ConfigError unless all are finite, the cut-offs > 0 and beta >= 0.
  void validate() const;
};

// One scalar.
class OneEuroFilter {
 public:
  // dt_s: seconds since the last call, > 0. scale: speed is measured on scale * value, the result has the value's unit.
  // The first value after construction or reset() comes back unchanged.
  double filter(const OneEuroOptions& options, double value, double dt_s, double scale = 1.0);
  void reset() { started_ = false; }

 private:
  bool started_ = false;
  double raw_ = 0;    // last input
  double value_ = 0;  // last output
  double speed_ = 0;  // smoothed, scaled units per second
};

}  // namespace livecap::detect
