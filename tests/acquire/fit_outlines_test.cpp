// A limb that is too thin and too short, and one that is too thick, become what their analytic outlines are.
#include "acquire/fit_outlines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

constexpr double kTubeRadius = 35, kTubeHalf = 200;
constexpr double kBelowAll = -1000;

double capsule(const Vector3d& p, double radius) {
  return (p - Vector3d(0, std::clamp(p.y(), -kTubeHalf, kTubeHalf), 0)).norm() - radius;
}

// With every vertex on it.
meshing::Surface capsule_surface(double radius) {
  meshing::Surface surface = meshing::extract_surface([&](const Vector3d& p) { return capsule(p, radius); },
                                                      {-80, -280, -80}, {80, 280, 80}, 12);
  for (Vector3d& p : surface.vertices) {
    const Vector3d axis(0, std::clamp(p.y(), -kTubeHalf, kTubeHalf), 0);
    p = axis + radius * (p - axis).normalized();
  }
  return surface;
}

// Nearest distance of a ray from the segment along Y between -half and half, by ternary search along the segment: the
// distance of a point to a line is convex.
double ray_to_axis(const Vector3d& from, const Vector3d& direction, double half) {
  const auto to_ray = [&](double y) { return (Vector3d(0, y, 0) - from).cross(direction).norm(); };
  double low = -half, high = half;
  for (int i = 0; i < 32; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (to_ray(a) < to_ray(b) ? high : low) = to_ray(a) < to_ray(b) ? b : a;
  }
  return to_ray((low + high) / 2);
}

std::vector<View> views_of_capsule() {
  constexpr int kViews = 24, kSize = 240;
  std::vector<View> views;
  for (int i = 0; i < kViews; ++i) {
    const double turn = 2 * M_PI * i / kViews, height = 300 * std::sin(5.0 * i);
    const Vector3d center(1500 * std::sin(turn), height, 1500 * std::cos(turn)), forward = -center.normalized();
    const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
    View view;
    view.camera = camera_from_fov(kSize, kSize, 22);
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    view.camera_from_world.linear() = rotation;
    view.camera_from_world.translation() = -rotation * center;
    view.mask = {kSize, kSize, std::vector<uint8_t>(size_t(kSize) * kSize, 0)};
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const Vector3d ray((x - view.camera.cx) / view.camera.fx, (y - view.camera.cy) / view.camera.fy, 1);
        if (ray_to_axis(center, (rotation.transpose() * ray).normalized(), kTubeHalf) < kTubeRadius)
          view.mask.pixels[size_t(y) * kSize + x] = 255;
      }
    views.push_back(std::move(view));
  }
  return views;
}

TEST(FitOutlines, ALimbEndsWhereItsOutlinesEnd) {
  const std::vector<View> views = views_of_capsule();
  test::on_every_device([&](ocl::DeviceContext& device) {
    for (const double off : {-3.0, 2.0}) {
      meshing::Surface surface = capsule_surface(kTubeRadius + off);
      fit_outlines(device, views, kBelowAll, surface);
      double sum = 0, worst = 0;
      for (const Vector3d& p : surface.vertices) {
        const double outside = capsule(p, kTubeRadius);
        sum += outside;
        worst = std::max(worst, std::abs(outside));
      }
      const double mean = sum / static_cast<double>(surface.vertices.size());
      std::printf("off by %g mm: %.2f in the mean afterwards, %.2f at most\n", off, mean, worst);
      EXPECT_NEAR(mean, 0, test::kOutlineMeanMm);
      EXPECT_LT(worst, test::kOutlineMm);
    }
  });
}

TEST(FitOutlines, WhatIsLowerStays) {
  const std::vector<View> views = views_of_capsule();
  test::on_every_device([&](ocl::DeviceContext& device) {
    meshing::Surface surface = capsule_surface(kTubeRadius - 3);
    const std::vector<Vector3d> before = surface.vertices;
    fit_outlines(device, views, 0, surface);
    int n_moved = 0;
    for (size_t i = 0; i < before.size(); ++i) {
      if (before[i].y() <= 0) EXPECT_EQ(surface.vertices[i], before[i]);
      n_moved += before[i].y() > 20 && (surface.vertices[i] - before[i]).norm() > 1;
    }
    EXPECT_GT(n_moved, static_cast<int>(before.size() / 3));
  });
}

// What no outline tells: the views have no masks, or show nobody.
TEST(FitOutlines, WithoutOutlinesNothingMoves) {
  std::vector<View> views = views_of_capsule();
  for (size_t i = 0; i < views.size(); ++i) {
    if (i % 2 == 0)
      views[i].mask = {};
    else
      std::fill(views[i].mask.pixels.begin(), views[i].mask.pixels.end(), 0);
  }
  test::on_every_device([&](ocl::DeviceContext& device) {
    meshing::Surface surface = capsule_surface(kTubeRadius);
    const std::vector<Vector3d> before = surface.vertices;
    fit_outlines(device, views, kBelowAll, surface);
    EXPECT_EQ(surface.vertices, before);
  });
}

}  // namespace
}  // namespace livecap::acquire
