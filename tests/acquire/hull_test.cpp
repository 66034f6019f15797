#include "acquire/hull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquire/true_actor.h"
#include "livecap/error.h"
#include "support/launched_kernels.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

// Pictures of an analytic solid: a pixel is covered when its ray comes nearer to the segment a-b than the radius.
std::vector<View> capsule_views(int n, const Vector3d& a, const Vector3d& b, double radius) {
  std::vector<View> views;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * i / n, rise = 0.35 * std::sin(2.1 * i);
    const Vector3d from =
        2500 * Vector3d(std::sin(angle) * std::cos(rise), std::sin(rise), std::cos(angle) * std::cos(rise));
    const Vector3d forward = -from.normalized(), right = forward.cross(Vector3d::UnitY()).normalized();
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    View view;
    view.camera = {400, 400, 500, 500, 199.5, 199.5, {}};
    view.camera_from_world.linear() = rotation;
    view.camera_from_world.translation() = -rotation * from;
    view.mask = {400, 400, std::vector<uint8_t>(400 * 400, 0)};
    for (int y = 0; y < 400; ++y)
      for (int x = 0; x < 400; ++x) {
        const Vector3d d = (rotation.transpose() * Vector3d((x - 199.5) / 500, (y - 199.5) / 500, 1)).normalized();
        // Nearest points of the ray and the segment, by sampling the segment finely.
        double nearest = 1e9;
        for (int k = 0; k <= 40; ++k) {
          const Vector3d p = a + (b - a) * (k / 40.0) - from;
          nearest = std::min(nearest, p.cross(d).norm());
        }
        view.mask.pixels[y * 400 + x] = nearest < radius ? 255 : 0;
      }
    views.push_back(view);
  }
  return views;
}

TEST(Hull, OfACapsuleIsTheCapsule) {
  const Vector3d a(-150, -250, 40), b(150, 250, -40);
  const double radius = 120;
  const auto views = capsule_views(36, a, b, radius);
  test::on_every_device([&](ocl::DeviceContext& device) {
    Volume volume = make_volume(Vector3d::Constant(-450), Vector3d::Constant(450), 12);
    acquire::carve_hull(device, views, {}, volume);
    keep_largest_solid(volume);
    const auto surface = surface_of(volume);
    ASSERT_GT(surface.vertices.size(), 1000u);
    double sum = 0, most = 0;
    for (const Vector3d& p : surface.vertices) {
      const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      const double error = std::abs((p - a - t * (b - a)).norm() - radius);
      sum += error;
      most = std::max(most, error);
    }
    EXPECT_LT(sum / surface.vertices.size(), test::kHullMeanMm);
    EXPECT_LT(most, test::kHullMostMm);
    // A view that shows nothing where the capsule is: overruled when asked, else it cuts everything away.
    auto broken = views;
    std::fill(broken[5].mask.pixels.begin(), broken[5].mask.pixels.begin() + 200 * 400, 0);
    acquire::HullOptions options;
    options.n_ignored = 1;
    acquire::carve_hull(device, broken, options, volume);
    EXPECT_LT(volume.at(b), 0);
    // Not where its mask is exact; of those that are not one still may be.
    broken[5].exact_mask = true;
    acquire::carve_hull(device, broken, options, volume);
    EXPECT_GT(volume.at(b), 0);
    auto others = broken;
    for (View& view : others) view.exact_mask = true;
    others[5].exact_mask = false;
    acquire::HullOptions seen_by_any = options;
    seen_by_any.min_seen = 0;
    acquire::carve_hull(device, others, seen_by_any, volume);
    others.erase(others.begin() + 5);
    seen_by_any.n_ignored = 0;
    Volume of_others = volume;
    acquire::carve_hull(device, others, seen_by_any, of_others);
    EXPECT_EQ(volume.distance, of_others.distance);
    broken[5].exact_mask = false;
    options.n_ignored = 0;
    acquire::carve_hull(device, broken, options, volume);
    EXPECT_GT(volume.at(b), 0);
    // Several such views, overruled below a height alone.
    for (const int i : {2, 11, 20, 29}) std::fill(broken[i].mask.pixels.begin(), broken[i].mask.pixels.end(), 0);
    for (const int i : {2, 11, 20, 29}) broken[i].mask.pixels[0] = 255;
    options.n_ignored_low = 5;
    for (const double low_mm : {b.y() - 50, b.y() + 50}) {
      options.low_mm = low_mm;
      acquire::carve_hull(device, broken, options, volume);
      EXPECT_LT(volume.at(a), 0);
      EXPECT_EQ(volume.at(b) < 0, low_mm > b.y());
    }
    EXPECT_THROW(acquire::carve_hull(device, std::vector<View>{}, options, volume), ConfigError);
  });
}

TEST(Hull, SelfTestPasses) {
  test::on_every_device([](ocl::DeviceContext& device) {
    for (const auto& result : acquire::acquire_self_test(device))
      EXPECT_TRUE(result.ok) << result.kernel << result.detail;
    test::expect_every_kernel_launched(device.info(), "acquire/carve.cl", acquire::acquire_self_test);
  });
}

}  // namespace
}  // namespace livecap
