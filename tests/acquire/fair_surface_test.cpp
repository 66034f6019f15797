// Two limbs beside each other, seen from one height: their hull has webs between them that no outline cuts away.
#include "acquire/fair_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "acquire/hull.h"
#include "acquire/limb.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

constexpr double kBeside = 42;  // 14 mm between them

double outside_mm(const Vector3d& p) {
  const Vector3d x(kBeside, 0, 0);
  return std::min(limb_distance(p - x, kLimbRadius), limb_distance(p + x, kLimbRadius));
}

// Drawn once.
const std::vector<View>& level_views() {
  static const std::vector<View> views = limb_views({-kBeside, kBeside}, 0);
  return views;
}

struct Hull {
  std::vector<View> views = level_views();
  Volume volume = make_volume({-150, -280, -120}, {150, 280, 120}, 7);
  meshing::Surface surface;
  explicit Hull(ocl::DeviceContext& device) {
    carve_hull(device, views, {}, volume);
    blur(volume, 5, 2);
    // With edges as long as an actor's.
    surface = meshing::extract_surface([&](const Vector3d& p) { return volume.at(p); }, volume.low, volume.high(), 16);
  }
};

// Mean of |outside_mm| where the hull is right, within 3 mm, and where it is too large.
std::pair<double, double> errors(const meshing::Surface& surface, const std::vector<Vector3d>& before) {
  double right = 0, large = 0;
  int n_right = 0, n_large = 0;
  for (size_t i = 0; i < before.size(); ++i) {
    const double mm = std::abs(outside_mm(surface.vertices[i]));
    if (outside_mm(before[i]) < 3)
      right += mm, ++n_right;
    else
      large += mm, ++n_large;
  }
  return {right / n_right, large / n_large};
}

TEST(FairSurface, WhatNoOutlineHoldsFollowsWhatTheyHold) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    Hull hull(device);
    const std::vector<Vector3d> before = hull.surface.vertices;
    const auto [right, large] = errors(hull.surface, before);
    fair_surface(seen_outlines(hull.views), hull.volume, hull.volume, kBelowAll, hull.surface);
    const auto [right_then, large_then] = errors(hull.surface, before);
    std::printf("too large by %.2f mm, then %.2f; elsewhere off by %.2f, then %.2f\n", large, large_then, right,
                right_then);
    EXPECT_GT(large, 4);
    EXPECT_LT(large_then, test::kFairedShare * large);
    EXPECT_LT(right_then, right + test::kFairedMm);
    for (size_t i = 0; i < before.size(); ++i)
      EXPECT_LT(hull.volume.at(hull.surface.vertices[i]), hull.volume.at(before[i]) + test::kBeyondHullMm)
          << "left the hull";
  });
}

TEST(FairSurface, WhatIsLowerStays) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    Hull hull(device);
    const std::vector<Vector3d> before = hull.surface.vertices;
    fair_surface(seen_outlines(hull.views), hull.volume, hull.volume, 50, hull.surface);
    int n_moved = 0;
    for (size_t i = 0; i < before.size(); ++i) {
      if (before[i].y() <= 50) EXPECT_EQ(hull.surface.vertices[i], before[i]);
      n_moved += (hull.surface.vertices[i] - before[i]).norm() > 1;
    }
    EXPECT_GT(n_moved, 20);
  });
}

TEST(FairSurface, WithoutOutlinesNothingMoves) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    Hull hull(device);
    const std::vector<Vector3d> before = hull.surface.vertices;
    for (View& view : hull.views) std::fill(view.mask.pixels.begin(), view.mask.pixels.end(), 0);
    fair_surface(seen_outlines(hull.views), hull.volume, hull.volume, kBelowAll, hull.surface);
    EXPECT_EQ(hull.surface.vertices, before);
    for (View& view : hull.views) view.mask = {};
    fair_surface(seen_outlines(hull.views), hull.volume, hull.volume, kBelowAll, hull.surface);
    EXPECT_EQ(hull.surface.vertices, before);
  });
}

}  // namespace
}  // namespace livecap::acquire
