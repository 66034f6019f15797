#include "image/video_camera.h"

#include "base/floor_plane.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

namespace {

Camera camera_of_size(const std::string& file, const VideoInfo& info, const std::string& video) {
  Camera camera = load_camera(file);
  if (camera.width != info.width || camera.height != info.height)
    throw IoError(file + format(": width and height are %dx%d but %s is %dx%d; calibrate at the video's size",
                                camera.width, camera.height, video.c_str(), info.width, info.height));
  return camera;
}

}  // namespace

Camera video_camera(const std::string& camera_file, double fov_deg, const VideoInfo& info, const std::string& video,
                    const std::string& floor_file) {
  Camera camera = camera_file.empty() ? camera_from_fov(info.width, info.height, fov_deg)
                                      : camera_of_size(camera_file, info, video);
  if (!floor_file.empty()) camera.floor = load_floor(floor_file);
  return camera;
}

}  // namespace livecap
