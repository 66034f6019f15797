// A limb, and what cameras around it see of it, by formula.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "meshing/isosurface.h"
#include "views/view.h"

namespace livecap::acquire {

inline constexpr double kBelowAll = -1000;  // nothing of it is lower

inline constexpr double kLimbRadius = 35, kLimbHalf = 200;

inline double limb_distance(const Eigen::Vector3d& p, double radius) {
  return (p - Eigen::Vector3d(0, std::clamp(p.y(), -kLimbHalf, kLimbHalf), 0)).norm() - radius;
}

// With every vertex on it.
inline meshing::Surface limb_surface(double radius) {
  meshing::Surface surface = meshing::extract_surface(
      [&](const Eigen::Vector3d& p) { return limb_distance(p, radius); }, {-80, -280, -80}, {80, 280, 80}, 12);
  for (Eigen::Vector3d& p : surface.vertices) {
    const Eigen::Vector3d axis(0, std::clamp(p.y(), -kLimbHalf, kLimbHalf), 0);
    p = axis + radius * (p - axis).normalized();
  }
  return surface;
}

// Nearest distance of a ray from the segment along Y between -half and half, by ternary search along the segment: the
// distance of a point to a line is convex.
inline double ray_to_axis(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double half) {
  const auto to_ray = [&](double y) { return (Eigen::Vector3d(0, y, 0) - from).cross(direction).norm(); };
  double low = -half, high = half;
  for (int i = 0; i < 32; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (to_ray(a) < to_ray(b) ? high : low) = to_ray(a) < to_ray(b) ? b : a;
  }
  return to_ray((low + high) / 2);
}

// Limbs that stand at these x, from all around, at heights up to rise_mm.
inline std::vector<View> limb_views(const std::vector<double>& limbs = {0}, double rise_mm = 300) {
  constexpr int kViews = 24, kSize = 240;
  std::vector<View> views;
  for (int i = 0; i < kViews; ++i) {
    const double turn = 2 * M_PI * i / kViews, height = rise_mm * std::sin(5.0 * i);
    const Eigen::Vector3d center(1500 * std::sin(turn), height, 1500 * std::cos(turn)), forward = -center.normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY()).normalized();
    View view;
    view.camera = camera_from_fov(kSize, kSize, 22);
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    view.camera_from_world.linear() = rotation;
    view.camera_from_world.translation() = -rotation * center;
    view.mask = {kSize, kSize, std::vector<uint8_t>(size_t(kSize) * kSize, 0)};
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const Eigen::Vector3d ray((x - view.camera.cx) / view.camera.fx, (y - view.camera.cy) / view.camera.fy, 1);
        const Eigen::Vector3d direction = (rotation.transpose() * ray).normalized();
        for (const double limb : limbs)
          if (ray_to_axis(center - Eigen::Vector3d(limb, 0, 0), direction, kLimbHalf) < kLimbRadius)
            view.mask.pixels[size_t(y) * kSize + x] = 255;
      }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace livecap::acquire
