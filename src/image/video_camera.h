// The camera of a video: from its file, or assumed.
#pragma once

#include <string>

#include "image/video.h"
#include "livecap/camera.h"

namespace livecap {

// camera_file: camera.json; empty: one without distortion whose longer side sees fov_deg. video: its name in messages.
// floor_file: see load_floor; its floor instead of the camera's; empty: that. Throws IoError when a file is none of its
// kind or a camera's of another size than the video, ConfigError for a fov_deg outside 1..170.
Camera video_camera(const std::string& camera_file, double fov_deg, const VideoInfo& info, const std::string& video,
                    const std::string& floor_file = {});

}  // namespace livecap
