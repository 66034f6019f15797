#include "detect/jump_gate.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::detect {

void JumpGateOptions::validate() const {
  const bool finite = std::isfinite(jump_mm) && std::isfinite(turn_mm_s) && std::isfinite(believed_after_s);
  if (!finite || jump_mm <= 0 || turn_mm_s < 0 || believed_after_s < 0)
    throw ConfigError(
        format("jump gate: jump %g mm must be positive, turn %g mm/s and believed_after %g s not negative", jump_mm,
               turn_mm_s, believed_after_s));
}

bool JumpGate::update(const JumpGateOptions& options, double dt_s, double mm_per_px,
                      std::array<KeypointDetection, kKeypointCount>& keypoints) {
  bool any = false;
  for (int k = 0; k < kKeypointCount; ++k) {
    KeypointDetection& now = keypoints[k];
    Followed& followed = followed_[k];
    if (!started_) {
      followed = {now};
      continue;
    }
    const double since_s = followed.doubted_s + dt_s;
    const double move_x_px = now.x_px - followed.last.x_px, move_y_px = now.y_px - followed.last.y_px;
    const double away_px =
        std::min(std::hypot(move_x_px, move_y_px),
                 std::hypot(move_x_px - followed.speed_x_px_s * since_s, move_y_px - followed.speed_y_px_s * since_s));
    if (away_px * mm_per_px > options.jump_mm + options.turn_mm_s * since_s &&
        followed.doubted_s < options.believed_after_s) {
      followed.doubted_s = since_s;
      now = followed.last;
      now.confidence = 0;
      any = true;
      continue;
    }
    const bool returns = followed.doubted_s > 0;
    followed.speed_x_px_s = returns ? 0 : move_x_px / dt_s;
    followed.speed_y_px_s = returns ? 0 : move_y_px / dt_s;
    followed.last = now;
    followed.doubted_s = 0;
  }
  started_ = true;
  return any;
}

}  // namespace livecap::detect
