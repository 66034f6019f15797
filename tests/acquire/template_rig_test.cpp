#include "acquire/template_rig.h"

#include <gtest/gtest.h>

namespace livecap::acquire {
namespace {

// A forearm of two twist bones outweighs the upper arm, which is stronger than either.
TEST(TemplateRig, BonesThatCountAsOneWeighTogether) {
  const std::vector<BodyBone> bones = {kHipsBone, kLeftArmBone, kLeftForeArmBone, kLeftForeArmBone};
  const meshing::Influences weights = {{{1, 0.4}, {2, 0.35}, {3, 0.25}, {0, 0}}};
  const meshing::Influences result = body_influences(weights, bones);
  EXPECT_EQ(result[0].bone, kLeftForeArmBone);
  EXPECT_DOUBLE_EQ(result[0].weight, 0.6);
  EXPECT_EQ(result[1].bone, kLeftArmBone);
  EXPECT_DOUBLE_EQ(result[1].weight, 0.4);
  for (const int unused : {2, 3}) {
    EXPECT_EQ(result[unused].bone, 0);
    EXPECT_EQ(result[unused].weight, 0);
  }
}

}  // namespace
}  // namespace livecap::acquire
