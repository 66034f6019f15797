// Keeps left and right apart over time. Pose networks now and then exchange the subject's left and right for some
// frames (a hidden face, bent over, blurred) while the points in the picture stay right: they take the front of the
// person for the back. Then the names need to go back, and the depths, which belong to a person who faces the other
// way, are of no use.
#pragma once

#include <array>

#include "base/detections.h"

namespace livecap::detect {

struct SideTrackerOptions {
  double memory_s = 1.0;   // how long agreement is remembered at most
  double change_s = 0.15;  // the network's sides are adopted when it disagreed this much longer than it agreed

  // Throws ConfigError unless both are positive and finite.
  void validate() const;
};

// What is nearer to the last frame's points decides which side is which, for arms and legs each on their own, because
// networks also exchange one without the other; but hips do not face away from the shoulders, so the legs follow the
// arms where these two are clear. A network that keeps disagreeing is believed in the end, so that a wrong beginning
// heals. The eyes go with the arms. Keypoints of an exchanged group keep the depth they had when the network last
// agreed (head, face and neck: with the arms).
class SideTracker {
 public:
  // Exchanges left and right of the keypoints where that continues the past. True when it exchanged anything. dt_s > 0;
  // mm_per_px: roughly the size of a pixel at the person, weighs 2D against 3D distances.
  bool update(const SideTrackerOptions& options, double dt_s, double mm_per_px,
              std::array<KeypointDetection, kKeypointCount>& keypoints);
  // Whether it began to believe the network in the last update: then keypoints lie elsewhere than in the frame before.
  bool changed_sides() const { return changed_sides_; }
  void reset() { started_ = false; }

 private:
  bool started_ = false;
  bool changed_sides_ = false;
  double agreement_s_[2] = {0, 0};  // arms, legs: time the network agreed minus time it disagreed
  std::array<KeypointDetection, kKeypointCount> last_{};
  std::array<float, kKeypointCount> agreed_z_mm_{};  // depth when the network last agreed
};

}  // namespace livecap::detect
