// What monocular networks get wrong about a person's posture, taken out of the 3D keypoints. Over whole sequences with
// ground truth (docs/accuracy.md), in the person's own frame:
//  - the trunk's lean towards the camera or away from it is mostly noise of 7 to 11 degrees, larger than what people
//    really lean and hardly related to it; only its mean over time is right, and that leans too far forward;
//  - thighs are too straight: knees are further forward than the network says.
#pragma once

#include <array>

#include "livecap/detections.h"

namespace livecap::detect {

// Leans are components of unit vectors: of mid-hip to neck, of hip to knee.
struct PostureOptions {
  // A lean towards or from the camera is taken for noise as far as it is within this of the usual one.
  double lean_dead_zone = 0.25;
  double seen_forward_lean = 0.16;   // how far upright people lean forward to the network ...
  double usual_forward_lean = 0.08;  // ... and really
  double camera_memory_s = 10;       // over which the camera's tilt is averaged from the rest of the lean
  double camera_level_s = 0.5;       // for how much time it counts that cameras are usually level
  double thigh_forward = 0.1;        // what knees are moved forward by, as a share of the thigh

  // Throws ConfigError naming the field when a time is not positive and finite, or a lean or share outside 0..1.
  void validate() const;
};

class Posture {
 public:
  // Turns trunk and thighs and moves what hangs on them along; lengths stay. dt_s > 0. A person whose front cannot be
  // told (points in one place, in a line, or no numbers) stays as seen.
  void update(const PostureOptions& options, double dt_s, std::array<KeypointDetection, kKeypointCount>& keypoints);
  void reset() { seen_s_ = 0; }

 private:
  double seen_s_ = 0;  // time that the average stands for; 0 = not begun
  double tilt_ = 0;    // z of the upright direction in the camera frame
};

}  // namespace livecap::detect
