#include "render/viewpoint.h"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <random>

#include "support/tolerances.h"

namespace livecap::render {
namespace {

using Eigen::Vector3d;

Camera capturing_camera() {
  Camera camera;
  camera.width = 540;
  camera.height = 960;
  camera.fx = 1180;
  camera.fy = 1190;
  camera.cx = 262;
  camera.cy = 491;
  return camera;
}

Eigen::Vector2d projected(const Viewpoint& view, const Vector3d& point) {
  const Vector3d p = view.view_from_camera * point;
  return {view.camera.fx * p.x() / p.z() + view.camera.cx, view.camera.fy * p.y() / p.z() + view.camera.cy};
}

// A camera pitched down by 12 degrees in front of somebody: the floor's up in its frame.
const Surroundings kAround{{150, 220, 3400}, Vector3d(0, -std::cos(0.21), -std::sin(0.21))};

TEST(Viewpoint, AFittedCameraSeesThePictureThatIsFitted) {
  const Camera camera = capturing_camera();
  for (const auto& [width, height] : {std::pair{540, 960}, {270, 480}, {1920, 1080}, {97, 301}}) {
    const Camera fitted = fitted_camera(camera, width, height);
    const FittedBox box = fitted_box(camera.width, camera.height, width, height);
    EXPECT_TRUE(box.width == width || box.height == height);
    EXPECT_LE(std::abs(2 * box.left + box.width - width), 1);
    EXPECT_LE(std::abs(2 * box.top + box.height - height), 1);
    EXPECT_EQ(fitted.width, width);
    EXPECT_EQ(fitted.height, height);
    // The outer borders of the picture, half a pixel outside of the first and last centres, come to the box's.
    const auto x = [&](double u) { return fitted.fx * (u - camera.cx) / camera.fx + fitted.cx; };
    const auto y = [&](double v) { return fitted.fy * (v - camera.cy) / camera.fy + fitted.cy; };
    EXPECT_NEAR(x(-0.5), box.left - 0.5, test::kDoubleExact);
    EXPECT_NEAR(x(camera.width - 0.5), box.left + box.width - 0.5, test::kDoubleExact);
    EXPECT_NEAR(y(-0.5), box.top - 0.5, test::kDoubleExact);
    EXPECT_NEAR(y(camera.height - 0.5), box.top + box.height - 0.5, test::kDoubleExact);
  }
}

// The camera's place is found by walking around the person; OpenCV projects from there.
TEST(Viewpoint, ProjectsAsOpenCvDoesFromThere) {
  const Camera fitted = fitted_camera(capturing_camera(), 400, 500);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> offset(-700, 700);
  for (const Angles from : {Angles{0, 0}, {90, 0}, {180, 15}, {-37, -20}, {250, 60}, {12, 90}}) {
    const double distance = 4100;
    const Viewpoint view = viewpoint_about(fitted, kAround, from, distance);
    // From the person level towards the capturing camera, turned about the vertical, raised about the horizontal.
    Vector3d to_camera = -kAround.place_mm;
    to_camera -= kAround.up * kAround.up.dot(to_camera);
    const Eigen::AngleAxisd turn(from.azimuth_deg * M_PI / 180, kAround.up);
    const Vector3d level = (turn * to_camera).normalized();
    const Eigen::AngleAxisd raise(from.elevation_deg * M_PI / 180, level.cross(kAround.up));
    const Vector3d eye = kAround.place_mm + distance * (raise * level);
    const Vector3d forward = (kAround.place_mm - eye).normalized();
    const Vector3d down = -(raise * kAround.up), right = down.cross(forward);
    cv::Matx33d rotation;
    for (int k = 0; k < 3; ++k) rotation(0, k) = right[k], rotation(1, k) = down[k], rotation(2, k) = forward[k];
    cv::Vec3d rotation_vector;
    cv::Rodrigues(rotation, rotation_vector);
    const cv::Vec3d translation = -(rotation * cv::Vec3d(eye.x(), eye.y(), eye.z()));
    const cv::Matx33d intrinsics(fitted.fx, 0, 199.5, 0, fitted.fy, 249.5, 0, 0, 1);
    for (int i = 0; i < 20; ++i) {
      const Vector3d point = kAround.place_mm + Vector3d(offset(random), offset(random), offset(random));
      std::vector<cv::Point2d> expected;
      cv::projectPoints(std::vector<cv::Point3d>{{point.x(), point.y(), point.z()}}, rotation_vector, translation,
                        intrinsics, cv::noArray(), expected);
      const Eigen::Vector2d found = projected(view, point);
      EXPECT_NEAR(found.x(), expected[0].x, test::kProjectedPx) << from.azimuth_deg << " " << from.elevation_deg;
      EXPECT_NEAR(found.y(), expected[0].y, test::kProjectedPx) << from.azimuth_deg << " " << from.elevation_deg;
    }
  }
}

TEST(Viewpoint, NinetyDegreesSeesTheLeftOfWhoFacesTheCamera) {
  const Surroundings level{{0, 0, 3000}, -Vector3d::UnitY()};
  const Camera fitted = fitted_camera(capturing_camera(), 400, 400);
  const Viewpoint left = viewpoint_about(fitted, level, {90, 0}, 2000);
  const Vector3d eye = left.view_from_camera.inverse().translation();
  EXPECT_NEAR((eye - Vector3d(2000, 0, 3000)).norm(), 0, test::kDoubleExact * 2000);  // the picture's right: their left
  // The face, which is nearer to the capturing camera, is at the left of this picture; the head is at the top.
  EXPECT_LT(projected(left, {0, 0, 2800}).x(), 199.5);
  EXPECT_LT(projected(left, {0, -700, 3000}).y(), 199.5);
}

TEST(Viewpoint, TheLeastDistanceShowsEverythingAndLessDoesNot) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> offset(-900, 900);
  std::vector<Vector3d> points;
  for (int i = 0; i < 40; ++i)
    points.push_back(kAround.place_mm + Vector3d(offset(random), offset(random), offset(random)));
  const Camera fitted = fitted_camera(capturing_camera(), 640, 360);
  for (const Angles from : {Angles{0, 0}, {75, 20}, {190, -30}}) {
    const double least = distance_to_see(points, 0, fitted, kAround, from);
    const auto farthest_out = [&](double distance) {  // 1: on the border
      const Viewpoint view = viewpoint_about(fitted, kAround, from, distance);
      double most = 0;
      for (const Vector3d& point : points) {
        const Eigen::Vector2d p = projected(view, point);
        most = std::max({most, std::abs(p.x() - 319.5) / 320, std::abs(p.y() - 179.5) / 180});
      }
      return most;
    };
    EXPECT_NEAR(farthest_out(least), 1, test::kDoubleExact);
    EXPECT_GT(farthest_out(0.99 * least), 1);
    EXPECT_GT(distance_to_see(points, 100, fitted, kAround, from), least);
  }
}

}  // namespace
}  // namespace livecap::render
