// What the energy of a frame usually is: a running mean of the last ten or so. Where a frame's is far above it, a limb
// has strayed or there is much that the actor does not explain.
#pragma once

namespace livecap {

class UsualEnergy {
 public:
  // energy >= 0. One far above the mean counts as kMost times it.
  void learn(double energy);
  // Whether it is more than `times` the mean; never before kFewest frames.
  bool exceeded_by(double energy, double times) const { return frames_ >= kFewest && energy > times * mean_; }

  static constexpr int kFewest = 6;
  static constexpr double kMost = 1.5;

 private:
  int frames_ = 0;
  double mean_ = 0;
};

}  // namespace livecap
