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
  const std::array<Followed, kKeypointCount> before = followed_;
  bool any = false;
  for (int k = 0; k < kKeypointCount; ++k) {
    KeypointDetection& now = keypoints[k];
    Followed& followed = followed_[k];
    if (!started_) {
      followed = {now};
      continue;
    }
    const auto follows = [&](const Followed& past) {
      const double since_s = past.doubted_s + dt_s;
      const double x_px = now.x_px - past.last.x_px, y_px = now.y_px - past.last.y_px;
      const double away_px = std::min(
          std::hypot(x_px, y_px), std::hypot(x_px - past.speed_x_px_s * since_s, y_px - past.speed_y_px_s * since_s));
      return away_px * mm_per_px <= options.jump_mm + options.turn_mm_s * since_s;
    };
    const bool goes_on = follows(before[k]);
    if (!goes_on && !follows(before[other_side(k)]) && followed.doubted_s < options.believed_after_s) {
      followed.doubted_s += dt_s;
      now = followed.last;
      any = true;
      continue;
    }
    const bool moves = goes_on && followed.doubted_s == 0;
    followed.speed_x_px_s = moves ? (now.x_px - followed.last.x_px) / dt_s : 0;
    followed.speed_y_px_s = moves ? (now.y_px - followed.last.y_px) / dt_s : 0;
    followed.last = now;
    followed.doubted_s = 0;
  }
  started_ = true;
  return any;
}

}  // namespace livecap::detect
