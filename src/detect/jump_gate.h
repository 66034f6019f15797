// Leaves out what no limb can do. Between two readings of a picture (a hidden face, legs that cross) a network's answer
// can lie halfway for a single frame: hands before the belly, with a score of 0.98. One such frame is enough to throw
// an arm, and a tracker needs long to find it again.
#pragma once

#include <array>

#include "base/detections.h"

namespace livecap::detect {

struct JumpGateOptions {
  // A keypoint that lies further than jump_mm + turn_mm_s * (seconds since it was last believed) both from where it was
  // and from where its last speed would have taken it, and as far from its other side, has jumped. jump_mm is for
  // noise, turn_mm_s for how much a hand's speed changes. (Where left and right are exchanged nothing has jumped:
  // others decide which is which, see side_tracker.h and pose/leg_exchange.h.)
  double jump_mm = 150;
  double turn_mm_s = 3000;
  double believed_after_s = 0.1;  // one that stays away so long is believed

  // Throws ConfigError unless all are finite, jump_mm > 0 and the others >= 0.
  void validate() const;
};

// Judged in the picture, keypoint by keypoint.
class JumpGate {
 public:
  // Keypoints that jumped are put back to where they were, 3D and confidence as well. dt_s > 0; mm_per_px:
  // roughly the size of a pixel at the person. True when there were any. Where more than half of
  // them jump it is another picture (a cut, somebody else), and all are believed.
  bool update(const JumpGateOptions& options, double dt_s, double mm_per_px,
              std::array<KeypointDetection, kKeypointCount>& keypoints);
  void reset() { started_ = false; }

 private:
  struct Followed {
    KeypointDetection last;  // believed
    double speed_x_px_s = 0, speed_y_px_s = 0;
    double doubted_s = 0;
  };

  bool started_ = false;
  std::array<Followed, kKeypointCount> followed_;
};

}  // namespace livecap::detect
