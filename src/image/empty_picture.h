// The picture of the empty scene that goes with a video.
#pragma once

#include <string>

#include "base/image_rgb.h"
#include "image/video.h"

namespace livecap {

// As it is in the file. Throws IoError when it cannot be read or is not of the video's size.
ImageRgb read_empty_picture(const std::string& file, const VideoInfo& video);

}  // namespace livecap
