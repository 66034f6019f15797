#include "image/undistort.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

Camera lens() {
  Camera camera;
  camera.width = 161;
  camera.height = 120;
  camera.fx = 150;
  camera.fy = 148;
  camera.cx = 78.5;
  camera.cy = 61.2;
  camera.distortion = {-0.21, 0.06, 0.003, -0.002, 0.01};
  return camera;
}

// Colours that say where a pixel was taken from.
ImageRgb ramp(int width, int height) {
  ImageRgb image{width, height, std::vector<uint8_t>(size_t(3) * width * height)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      uint8_t* p = &image.pixels[3 * (size_t(y) * width + x)];
      p[0] = static_cast<uint8_t>(x);
      p[1] = static_cast<uint8_t>(y);
      p[2] = 77;
    }
  }
  return image;
}

TEST(Undistort, TakesPixelsFromWhereTheLensPutThem) {
  const Camera camera = lens();
  const Undistorter undistorter(camera);
  const ImageRgb out = undistorter.undistort(ramp(camera.width, camera.height));
  const cv::Matx33d intrinsics(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Vec<double, 5> distortion(camera.distortion[0], camera.distortion[1], camera.distortion[2],
                                      camera.distortion[3], camera.distortion[4]);
  double moved = 0;
  for (int y = 5; y < camera.height; y += 9) {
    for (int x = 4; x < camera.width; x += 11) {
      // OpenCV projects the viewing ray of the undistorted pixel through the lens.
      std::vector<cv::Point3d> ray = {{(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1}};
      std::vector<cv::Point2d> from;
      cv::projectPoints(ray, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), intrinsics, distortion, from);
      const uint8_t* p = &out.pixels[3 * (size_t(y) * camera.width + x)];
      EXPECT_NEAR(p[0], std::clamp(from[0].x, 0.0, camera.width - 1.0), test::kUndistortPx) << x << "," << y;
      EXPECT_NEAR(p[1], std::clamp(from[0].y, 0.0, camera.height - 1.0), test::kUndistortPx) << x << "," << y;
      EXPECT_EQ(p[2], 77);
      moved = std::max(moved, std::hypot(from[0].x - x, from[0].y - y));
    }
  }
  EXPECT_GT(moved, 3);
}

TEST(Undistort, WithoutDistortionNothingChanges) {
  Camera camera = lens();
  camera.distortion = {};
  const ImageRgb image = ramp(camera.width, camera.height);
  EXPECT_EQ(Undistorter(camera).undistort(image).pixels, image.pixels);
}

TEST(Undistort, CameraAndSizes) {
  const Undistorter undistorter(lens());
  EXPECT_FALSE(undistorter.undistorted_camera().has_distortion());
  EXPECT_EQ(undistorter.undistorted_camera().fx, lens().fx);
  EXPECT_THROW(undistorter.undistort(ramp(10, 10)), ConfigError);
  EXPECT_THROW(Undistorter(Camera{}), ConfigError);
}

}  // namespace
}  // namespace livecap
