// A block of cloth around two legs is opened from below; legs, walls and a body without a skirt stay.
#include "acquire/open_skirt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scan/scan.h"
#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

constexpr double kHem = 500, kLegX = 110, kLegRadius = 50, kSkirtRadius = 240, kStep = 8;

// Legs as posts, from the hem (or higher) up a drum with a flat underside.
double dressed(const Vector3d& p, double hem) {
  const double legs = std::min(std::hypot(p.x() - kLegX, p.z()), std::hypot(p.x() + kLegX, p.z())) - kLegRadius;
  const double drum = std::max(std::hypot(p.x(), p.z()) - kSkirtRadius, hem - p.y());
  return std::max({std::min(legs, drum), 20 - p.y(), p.y() - 1000});
}

Volume volume_with_hem(double hem) {
  Volume volume = make_volume({-300, -40, -300}, {300, 1060, 300}, kStep);
  for (int z = 0; z < volume.nz; ++z)
    for (int y = 0; y < volume.ny; ++y)
      for (int x = 0; x < volume.nx; ++x)
        volume.distance[volume.index(x, y, z)] =
            static_cast<float>(dressed(volume.low + kStep * Vector3d(x, y, z), hem));
  return volume;
}

SpaceKeypoints standing() {
  SpaceKeypoints seen;
  const auto put = [&](int k, double x, double y) { seen[k].found = true, seen[k].position = {x, y, 0}; };
  for (const double side : {1.0, -1.0}) {
    put(side > 0 ? kLeftHip : kRightHip, side * kLegX, 900);
    put(side > 0 ? kLeftKnee : kRightKnee, side * kLegX, 480);
    put(side > 0 ? kLeftAnkle : kRightAnkle, side * kLegX, 90);
  }
  return seen;
}

TEST(OpenSkirt, ALowRoof) {
  const Volume closed = volume_with_hem(kHem);
  Volume open = closed;
  ASSERT_TRUE(open_skirt(standing(), open));
  // In front of the legs, 80 mm from the cloth, of which it keeps 40, the roof is 28 mm higher than the hem; between
  // the legs it is no higher than 60 mm, though the cloth is 240 mm away there.
  EXPECT_GT(open.at({0, kHem + 28 - kStep, 160}), 0);
  EXPECT_LT(open.at({0, kHem + 28 + 1.5 * kStep, 160}), 0);
  EXPECT_GT(open.at({0, kHem + 60 - kStep, 0}), 0);
  EXPECT_LT(open.at({0, kHem + 60 + 1.5 * kStep, 0}), 0);
  // Beside the legs it is free up to the roof: they do not widen there.
  for (const double x : {-kLegX, kLegX}) EXPECT_GT(open.at({x, kHem + 40, kLegRadius + 15}), 0);
  // The hem and the legs stay.
  EXPECT_LT(open.at({0, kHem + 10, kSkirtRadius - 30}), 0);
  for (double angle = 0; angle < 6.2; angle += 0.3)
    EXPECT_LT(open.at((kSkirtRadius - 10) * Vector3d(std::cos(angle), 0, std::sin(angle)) + Vector3d(0, kHem + 10, 0)),
              0);
  for (const double x : {-kLegX, kLegX})
    for (const double y : {200.0, kHem + 20.0}) EXPECT_LT(open.at({x, y, 0}), -0.6 * kLegRadius);
  EXPECT_TRUE(is_closed_manifold(surface_of(open)));
  // Nothing is added, and nothing is taken elsewhere.
  for (size_t i = 0; i < open.size(); ++i) EXPECT_GE(open.distance[i], closed.distance[i]);
  for (const Vector3d& p : {Vector3d(0, 800, 0), Vector3d(200, 700, 0), Vector3d(kLegX, 100, 0)})
    EXPECT_EQ(open.at(p), closed.at(p));
}

TEST(OpenSkirt, TrousersAndLostLegsStay) {
  const Volume trousers = volume_with_hem(800);
  Volume volume = trousers;
  EXPECT_FALSE(open_skirt(standing(), volume));
  EXPECT_EQ(volume.distance, trousers.distance);
  SpaceKeypoints seen = standing();
  seen[kLeftKnee].found = false;
  volume = volume_with_hem(kHem);
  EXPECT_FALSE(open_skirt(seen, volume));
}

}  // namespace
}  // namespace livecap::acquire
