// How large the person is in a picture: what a 2D error is small or large against.
#pragma once

#include "base/detections.h"

namespace livecap {

// Vertical extent of the confident keypoints, px; 0 without any.
double keypoints_height_px(const Detections& detections);

}  // namespace livecap
