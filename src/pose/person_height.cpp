#include "pose/person_height.h"

#include <algorithm>

namespace livecap {

double keypoints_height_px(const Detections& detections) {
  double low = 1e9, high = -1e9;
  for (const KeypointDetection& keypoint : detections.keypoints) {
    if (keypoint.confidence < 0.3f) continue;
    low = std::min<double>(low, keypoint.y_px);
    high = std::max<double>(high, keypoint.y_px);
  }
  return high > low ? high - low : 0;
}

}  // namespace livecap
