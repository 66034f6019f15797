// Phones store pictures as the sensor saw them and note how to turn them. Readers of pictures turn them; COLMAP does
// not, so its cameras are those of the stored picture.
#pragma once

#include "views/camera_files.h"

namespace livecap {

// The camera of the picture after that many clockwise quarter turns, distortion included.
ViewPose turned(const ViewPose& view, int quarter_turns);

}  // namespace livecap
