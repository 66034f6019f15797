#include "base/detections.h"

namespace livecap {

const std::array<std::string_view, kKeypointCount> kKeypointNames = {
    "head_top",       "neck",       "pelvis",      "left_hip",   "right_hip",   "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_hand",
    "right_hand",     "left_knee",  "right_knee",  "left_ankle", "right_ankle", "left_toe",
    "right_toe",      "left_eye",   "right_eye",   "nose",       "chin"};

}  // namespace livecap
