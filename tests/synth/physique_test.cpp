#include <gtest/gtest.h>

#include <algorithm>

#include "livecap/error.h"
#include "support/tolerances.h"
#include "synth/actor_model.h"

namespace livecap::synth {
namespace {

TEST(Physique, StretchesBonesAtTheSameHeight) {
  const ActorModel plain = build_actor("trousers", 1820, 2000);
  ActorModel same = plain, tall_legs = plain;
  apply_physique({}, same);
  for (size_t i = 0; i < plain.surface.vertices.size(); ++i)
    ASSERT_EQ(plain.surface.vertices[i], same.surface.vertices[i]);
  Physique physique;
  physique.legs = 1.1, physique.arms = 0.9;
  apply_physique(physique, tall_legs);
  double top = -1e9, bottom = 1e9;
  for (const Vec3& p : tall_legs.surface.vertices) top = std::max(top, p.y()), bottom = std::min(bottom, p.y());
  EXPECT_NEAR(top - bottom, 1820, test::kMillimetreFloat);
  EXPECT_NEAR(bottom, 0, test::kMillimetreFloat);
  const auto ratio = [&](int from, int to) {
    return (tall_legs.joints[to] - tall_legs.joints[from]).norm() / (plain.joints[to] - plain.joints[from]).norm();
  };
  const double trunk = ratio(kHips, kSpine2);  // by as much as everything shrank to keep the height
  EXPECT_LT(trunk, 1);
  EXPECT_NEAR(ratio(kLeftUpLeg, kLeftLeg) / trunk, 1.1, test::kDoubleExact);
  EXPECT_NEAR(ratio(kRightLeg, kRightFoot) / trunk, 1.1, test::kDoubleExact);
  EXPECT_NEAR(ratio(kLeftArm, kLeftForeArm) / trunk, 0.9, test::kDoubleExact);
  // The surface goes with them: the crotch is higher, the soles are where they were.
  EXPECT_GT(tall_legs.joints[kHips].y(), plain.joints[kHips].y());
  physique.legs = 3;
  EXPECT_THROW(apply_physique(physique, same), ConfigError);
}

}  // namespace
}  // namespace livecap::synth
