#include "detect/jump_gate.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::detect {
namespace {

// Of a keypoint in the middle: itself.
int other_side(int keypoint) {
  static_assert((kRightEye - kLeftHip) % 2 == 1 && kRightWrist == kLeftWrist + 1, "left and right in turns");
  if (keypoint < kLeftHip || keypoint > kRightEye) return keypoint;
  return kLeftHip + ((keypoint - kLeftHip) ^ 1);
}

}  // namespace

void JumpGateOptions::validate() const {
  const bool finite = std::isfinite(jump_mm) && std::isfinite(turn_mm_s) && std::isfinite(believed_after_s);
  if (!finite || jump_mm <= 0 || turn_mm_s < 0 || believed_after_s < 0)
    throw ConfigError(
        format("jump gate: jump %g mm must be positive, turn %g mm/s and believed_after %g s not negative", jump_mm,
               turn_mm_s, believed_after_s));
}

bool JumpGate::update(const JumpGateOptions& options, double dt_s, double mm_per_px,
                      std::array<KeypointDetection, kKeypointCount>& keypoints) {
  const auto follows = [&](const KeypointDetection& now, const Followed& past) {
    const double since_s = past.doubted_s + dt_s;
    const double x_px = now.x_px - past.last.x_px, y_px = now.y_px - past.last.y_px;
    const double away_px = std::min(std::hypot(x_px, y_px),
                                    std::hypot(x_px - past.speed_x_px_s * since_s, y_px - past.speed_y_px_s * since_s));
    return away_px * mm_per_px <= options.jump_mm + options.turn_mm_s * since_s;
  };
  std::array<bool, kKeypointCount> moves{}, jumps{};
  for (int k = 0; k < kKeypointCount && started_; ++k) {
    const bool goes_on = follows(keypoints[k], followed_[k]);
    moves[k] = goes_on && followed_[k].doubted_s == 0;
    jumps[k] = !goes_on && !follows(keypoints[k], followed_[other_side(k)]) &&
               followed_[k].doubted_s < options.believed_after_s;
  }
  const auto n_jumps = std::count(jumps.begin(), jumps.end(), true);
  if (2 * n_jumps > kKeypointCount) jumps.fill(false);
  for (int k = 0; k < kKeypointCount; ++k) {
    KeypointDetection& now = keypoints[k];
    Followed& followed = followed_[k];
    if (jumps[k]) {
      followed.doubted_s += dt_s;
      now = followed.last;
      continue;
    }
    const Followed past = followed;
    followed = {.last = now};
    if (!moves[k]) continue;
    followed.speed_x_px_s = (now.x_px - past.last.x_px) / dt_s;
    followed.speed_y_px_s = (now.y_px - past.last.y_px) / dt_s;
  }
  started_ = true;
  return std::find(jumps.begin(), jumps.end(), true) != jumps.end();
}

}  // namespace livecap::detect
