#include "image/undistort.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

std::array<double, 2> distorted(const Camera& camera, double x, double y) {
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Undistorter::Undistorter(const Camera& camera) : camera_(camera) {
  camera.validate();
  if (!camera.has_distortion()) return;
  map_.resize(size_t(2) * camera.width * camera.height);
  fraction_.resize(size_t(camera.width) * camera.height);
  cv::Mat map_x(camera.height, camera.width, CV_32FC1), map_y = map_x.clone();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto [x, y] = distorted(camera, (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
      map_x.at<float>(v, u) = static_cast<float>(camera.fx * x + camera.cx);
      map_y.at<float>(v, u) = static_cast<float>(camera.fy * y + camera.cy);
    }
  }
  cv::Mat map(camera.height, camera.width, CV_16SC2, map_.data());
  cv::Mat fraction(camera.height, camera.width, CV_16UC1, fraction_.data());
  cv::convertMaps(map_x, map_y, map, fraction, CV_16SC2);
}

ImageRgb Undistorter::undistort(ImageRgb image) const {
  if (image.width != camera_.width || image.height != camera_.height)
    throw ConfigError(format("camera is for %dx%d pictures, the video has %dx%d", camera_.width, camera_.height,
                             image.width, image.height));
  if (map_.empty()) return image;
  ImageRgb out{image.width, image.height, std::vector<uint8_t>(image.pixels.size())};
  const cv::Mat from(image.height, image.width, CV_8UC3, image.pixels.data());
  cv::Mat to(image.height, image.width, CV_8UC3, out.pixels.data());
  const cv::Mat map(image.height, image.width, CV_16SC2, const_cast<int16_t*>(map_.data()));
  const cv::Mat fraction(image.height, image.width, CV_16UC1, const_cast<uint16_t*>(fraction_.data()));
  cv::remap(from, to, map, fraction, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

Camera Undistorter::undistorted_camera() const {
  Camera camera = camera_;
  camera.distortion = {};
  return camera;
}

}  // namespace livecap
