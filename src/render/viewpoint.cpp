#include "render/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace livecap::render {
namespace {

using Eigen::Vector3d;

// The view's axes in the camera's frame: to the right, down, forward.
Eigen::Matrix3d axes(const Surroundings& around, const Angles& from) {
  const Vector3d to_camera = -around.place_mm;
  Vector3d front = to_camera - around.up * around.up.dot(to_camera);
  front = front.norm() > 1 ? front.normalized() : around.up.unitOrthogonal();
  const Vector3d side = around.up.cross(front);
  const double azimuth = from.azimuth_deg * std::numbers::pi / 180;
  const double elevation = from.elevation_deg * std::numbers::pi / 180;
  const Vector3d level = std::cos(azimuth) * front + std::sin(azimuth) * side;
  const Vector3d forward = -(std::cos(elevation) * level + std::sin(elevation) * around.up);
  const Vector3d right = around.up.cross(level);
  Eigen::Matrix3d rows;
  rows << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  return rows;
}

}  // namespace

FittedBox fitted_box(int width, int height, int into_width, int into_height) {
  const double scale = std::min(static_cast<double>(into_width) / width, static_cast<double>(into_height) / height);
  FittedBox box;
  box.width = std::clamp(static_cast<int>(std::lround(scale * width)), 1, into_width);
  box.height = std::clamp(static_cast<int>(std::lround(scale * height)), 1, into_height);
  box.left = (into_width - box.width) / 2;
  box.top = (into_height - box.height) / 2;
  return box;
}

Camera fitted_camera(const Camera& camera, int width, int height) {
  const FittedBox box = fitted_box(camera.width, camera.height, width, height);
  const double x_scale = static_cast<double>(box.width) / camera.width;
  const double y_scale = static_cast<double>(box.height) / camera.height;
  Camera fitted = camera;
  fitted.width = width;
  fitted.height = height;
  fitted.fx *= x_scale;
  fitted.fy *= y_scale;
  fitted.cx = x_scale * (camera.cx + 0.5) - 0.5 + box.left;
  fitted.cy = y_scale * (camera.cy + 0.5) - 0.5 + box.top;
  return fitted;
}

Viewpoint viewpoint_about(const Camera& fitted, const Surroundings& around, const Angles& from, double distance_mm) {
  Viewpoint view;
  view.camera = fitted;
  view.camera.cx = 0.5 * (fitted.width - 1);
  view.camera.cy = 0.5 * (fitted.height - 1);
  view.camera.floor.reset();
  view.view_from_camera.linear() = axes(around, from);
  view.view_from_camera.translation() = Vector3d(0, 0, distance_mm) - view.view_from_camera.linear() * around.place_mm;
  return view;
}

double distance_to_see(std::span<const Vector3d> points_mm, double margin_mm, const Camera& fitted,
                       const Surroundings& around, const Angles& from) {
  const Eigen::Matrix3d view_from_camera = axes(around, from);
  double distance = 0;
  for (const Vector3d& point : points_mm) {
    const Vector3d p = view_from_camera * (point - around.place_mm);
    const double across = std::max((std::abs(p.x()) + margin_mm) * 2 * fitted.fx / fitted.width,
                                   (std::abs(p.y()) + margin_mm) * 2 * fitted.fy / fitted.height);
    distance = std::max(distance, across - p.z());
  }
  return distance;
}

}  // namespace livecap::render
