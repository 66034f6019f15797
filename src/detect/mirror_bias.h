// What a network says of a picture and of its mirror image differs by a little that stays the same over many frames.
// Shown in turns, that makes every keypoint tremble from frame to frame; here it is learned and taken out.
#pragma once

#include <array>

#include "base/detections.h"

namespace livecap::detect {

class MirrorBias {
 public:
  using Keypoints = std::array<KeypointDetection, kKeypointCount>;

  // Keypoints of the next picture, mirrored or not; moves each half the way to what the other kind would have said.
  void update(bool mirrored, Keypoints& keypoints);

  // The next picture does not follow the last one.
  void interrupt() { n_pictures_ = 0; }
  void reset() { *this = {}; }

 private:
  static constexpr int kChannels = 5;  // px, px, mm, mm, mm
  using Values = std::array<std::array<double, kChannels>, kKeypointCount>;

  Values last_{}, before_last_{};
  Values bias_{};       // of a mirrored picture against the mean of both kinds
  int n_pictures_ = 0;  // on end, in turns
  int n_learned_ = 0;   // from so many pictures
  bool last_mirrored_ = false;
};

}  // namespace livecap::detect
