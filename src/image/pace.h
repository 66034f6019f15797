// The pace at which the frames of a file were taken.
#pragma once

#include <optional>

#include "base/timer.h"

namespace livecap {

class Pace {
 public:
  // How long before its time a frame is, ms; negative when it is late. The clock starts with the first.
  double early_ms(double pts_ms) {
    if (!clock_) {
      clock_.emplace();
      first_pts_ms_ = pts_ms;
    }
    return pts_ms - first_pts_ms_ - clock_->elapsed_ms();
  }

 private:
  std::optional<Timer> clock_;
  double first_pts_ms_ = 0;
};

}  // namespace livecap
