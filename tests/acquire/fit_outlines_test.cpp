// A limb that is too thin and too short, and one that is too thick, become what their analytic outlines are.
#include "acquire/fit_outlines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquire/limb.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

TEST(FitOutlines, ALimbEndsWhereItsOutlinesEnd) {
  const std::vector<View> views = limb_views();
  test::on_every_device([&](ocl::DeviceContext& device) {
    for (const double off : {-3.0, 2.0}) {
      meshing::Surface surface = limb_surface(kLimbRadius + off);
      fit_outlines(device, views, seen_outlines(views), kBelowAll, surface);
      double sum = 0, worst = 0;
      for (const Vector3d& p : surface.vertices) {
        const double outside = limb_distance(p, kLimbRadius);
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
  const std::vector<View> views = limb_views();
  test::on_every_device([&](ocl::DeviceContext& device) {
    meshing::Surface surface = limb_surface(kLimbRadius - 3);
    const std::vector<Vector3d> before = surface.vertices;
    fit_outlines(device, views, seen_outlines(views), 0, surface);
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
  std::vector<View> views = limb_views();
  for (size_t i = 0; i < views.size(); ++i) {
    if (i % 2 == 0)
      views[i].mask = {};
    else
      std::fill(views[i].mask.pixels.begin(), views[i].mask.pixels.end(), 0);
  }
  test::on_every_device([&](ocl::DeviceContext& device) {
    meshing::Surface surface = limb_surface(kLimbRadius);
    const std::vector<Vector3d> before = surface.vertices;
    fit_outlines(device, views, seen_outlines(views), kBelowAll, surface);
    EXPECT_EQ(surface.vertices, before);
  });
}

}  // namespace
}  // namespace livecap::acquire
