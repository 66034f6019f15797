// Frames from a container or a capture device through libavformat and libavcodec.
#pragma once

#include <memory>
#include <string>

#include "image/video.h"

namespace livecap {

// Throws IoError naming the file when it holds no decodable video.
std::unique_ptr<FrameSource> open_video_file(const std::string& path);

// /dev/video<index>. Throws ConfigError when libavdevice is not installed, IoError when the device cannot be opened.
std::unique_ptr<FrameSource> open_webcam(int index);

}  // namespace livecap
