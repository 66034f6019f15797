// Removes lens distortion (Brown-Conrady), so that everything after it works with a plain pinhole camera.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/image_rgb.h"
#include "livecap/camera.h"

namespace livecap {

// Where the lens images the direction (x, y, 1) of the camera's frame, as the direction that a plain pinhole camera
// would image there. The pixel is fx * x + cx, fy * y + cy of it.
std::array<double, 2> distorted(const Camera& camera, double x, double y);

class Undistorter {
 public:
  // Sampling positions are computed once. A camera without distortion costs nothing later. Throws ConfigError.
  explicit Undistorter(const Camera& camera);

  // image must have the camera's size (ConfigError names both). Pixels that would come from outside repeat the border.
  ImageRgb undistort(ImageRgb image) const;

  // The same intrinsics without distortion.
  Camera undistorted_camera() const;

 private:
  Camera camera_;
  std::vector<int16_t> map_;        // [2*w*h] source pixel, OpenCV's fixed-point maps
  std::vector<uint16_t> fraction_;  // [w*h] index of the bilinear weights
};

}  // namespace livecap
