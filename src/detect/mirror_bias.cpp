#include "detect/mirror_bias.h"

#include <algorithm>
#include <cmath>

namespace livecap::detect {
namespace {

constexpr double kRate = 0.2;  // share of each new observation: the bias depends on the pose
// More than this is a keypoint that jumped.
constexpr double kLargestPx = 4, kLargestMm = 30;

}  // namespace

void MirrorBias::update(bool mirrored, Keypoints& keypoints) {
  if (n_pictures_ > 0 && mirrored == last_mirrored_) n_pictures_ = 0;
  const double sign = mirrored ? 1 : -1;
  const bool learn = n_pictures_ >= 2;
  if (learn) ++n_learned_;
  const double rate = std::max(kRate, 1.0 / (1 + n_learned_));
  for (int i = 0; i < kKeypointCount; ++i) {
    KeypointDetection& k = keypoints[i];
    float* const values[kChannels] = {&k.x_px, &k.y_px, &k.x_mm, &k.y_mm, &k.z_mm};
    for (int c = 0; c < kChannels; ++c) {
      const double value = *values[c];
      double& bias = bias_[i][c];
      if (learn) {
        // Steady motion cancels: what is left of the last picture against its neighbours is twice its own bias.
        const double largest = c < 2 ? kLargestPx : kLargestMm;
        const double seen = -sign * 0.5 * (last_[i][c] - 0.5 * (value + before_last_[i][c]));
        if (std::abs(seen) < largest) bias += rate * (seen - bias);
      }
      before_last_[i][c] = last_[i][c];
      last_[i][c] = value;
      *values[c] = static_cast<float>(value - sign * bias);
    }
  }
  last_mirrored_ = mirrored;
  ++n_pictures_;
}

}  // namespace livecap::detect
