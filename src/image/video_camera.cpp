#include "image/video_camera.h"

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

Camera video_camera(const std::string& camera_file, double fov_deg, const VideoInfo& info, const std::string& video) {
  if (camera_file.empty()) return camera_from_fov(info.width, info.height, fov_deg);
  Camera camera = load_camera(camera_file);
  if (camera.width != info.width || camera.height != info.height)
    throw IoError(camera_file + format(": width and height are %dx%d but %s is %dx%d; calibrate at the video's size",
                                       camera.width, camera.height, video.c_str(), info.width, info.height));
  return camera;
}

}  // namespace livecap
