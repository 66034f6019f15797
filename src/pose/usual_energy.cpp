#include "pose/usual_energy.h"

#include <algorithm>

namespace livecap {

void UsualEnergy::learn(double energy) {
  constexpr double kRate = 0.1;  // a frame's share of the mean
  if (frames_ >= kFewest - 1) energy = std::min(energy, kMost * mean_);
  if (frames_ < 1 / kRate) ++frames_;
  mean_ += std::max(kRate, 1.0 / frames_) * (energy - mean_);
}

}  // namespace livecap
