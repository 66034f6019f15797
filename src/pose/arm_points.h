// What the network sees of an arm, and the bones on which all of it and the forearm hang.
#pragma once

#include <array>

#include "base/detections.h"

namespace livecap {

struct ArmPoints {
  Keypoint upper, elbow, wrist;  // upper: the shoulder
  const char *shoulder, *forearm;
};

inline constexpr std::array<ArmPoints, 2> kArmPoints = {
    {{kLeftShoulder, kLeftElbow, kLeftWrist, "left_shoulder", "left_elbow"},
     {kRightShoulder, kRightElbow, kRightWrist, "right_shoulder", "right_elbow"}}};

}  // namespace livecap
