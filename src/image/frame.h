// One picture of the input stream, as it came: not yet undistorted.
#pragma once

#include <cstdint>

#include "base/image_rgb.h"

namespace livecap {

struct Frame {
  int64_t index = 0;     // counts every frame of the input from 0, damaged ones included
  double pts_ms = 0;     // presentation time since the first frame
  bool damaged = false;  // the decoder reported an error; the image is concealed or repeats the last good one
  ImageRgb image;
};

}  // namespace livecap
