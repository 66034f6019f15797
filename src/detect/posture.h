// What monocular networks get wrong about a person's posture, taken out of the 3D keypoints. Over whole sequences with
// ground truth (docs/experiments.md), in the person's own frame:
//  - the trunk's lean towards the camera or away from it is mostly noise of 7 to 11 degrees, larger than what people
//    really lean and hardly related to it; only its mean over time is right, and that leans too far forward;
//  - arms hang too close and too far back, knees are too close and too far back.
#pragma once

#include <array>

#include "base/detections.h"

namespace livecap::detect {

// What is added to the unit vector along a limb before it is scaled to the limb's length again, in the trunk's axes:
// away from the other side, towards the head, to the front.
struct LimbBias {
  double outward = 0;
  double upward = 0;
  double forward = 0;
};

// Leans are z components of the unit vector from mid-hip to neck.
struct PostureOptions {
  // A lean towards or from the camera is taken for noise as far as it is within this of the usual one.
  double lean_dead_zone = 0.25;
  double seen_forward_lean = 0.16;   // how far upright people lean forward to the network ...
  double usual_forward_lean = 0.08;  // ... and really
  double camera_memory_s = 10;       // over which the camera's tilt is averaged from the rest of the lean
  double camera_level_s = 0.5;       // for how much time it counts that cameras are usually level
  // Calibrated on rendered sequences of the built-in actors.
  LimbBias thigh{0.07, 0, 0.08};
  LimbBias upper_arm{0.07, 0.05, 0.07};
  LimbBias forearm{0, 0.05, 0.05};

  // Throws ConfigError naming the field when a time is not positive and finite, a lean or share outside 0..1,
  // or a bias outside -1..1.
  void validate() const;
};

class Posture {
 public:
  // Turns trunk, arms and thighs and moves what hangs on them along; lengths stay. dt_s > 0. A person whose front
  // cannot be told (points in one place, in a line, or no numbers) stays as seen.
  void update(const PostureOptions& options, double dt_s, std::array<KeypointDetection, kKeypointCount>& keypoints);
  void reset() { seen_s_ = 0; }

 private:
  double seen_s_ = 0;  // time that the average stands for; 0 = not begun
  double tilt_ = 0;    // z of the upright direction in the camera frame
};

}  // namespace livecap::detect
