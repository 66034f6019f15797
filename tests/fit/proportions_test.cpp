#include "fit/proportions.h"

#include <gtest/gtest.h>

#include "actor/bone_names.h"
#include "support/builtin_actor.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

TEST(Proportions, NothingChangesNothing) {
  const Actor& actor = test::builtin_actor("trousers");
  const Reshaper reshaper(actor);
  const Shape shape = reshaper.shape(Proportions::Zero());
  for (int i = 0; i < actor.n_vertices(); i += 7)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(reshaper.vertex(shape, i)[k], actor.mesh.positions[3 * i + k], test::kMillimetreFloat);
  for (int b = 0; b < actor.skeleton.n_bones(); ++b)
    EXPECT_LT((shape.skeleton.bones[b].offset_mm - actor.skeleton.bones[b].offset_mm).norm(), test::kMillimetreFloat);
}

TEST(Proportions, BonesGetTheirLengthsAndTheChainStaysTogether) {
  const Actor& actor = test::builtin_actor("trousers");
  const Reshaper reshaper(actor);
  Proportions proportions;
  for (int k = 0; k < kProportionCount; ++k) proportions[k] = 0.02 * (k - 5);
  const Shape before = reshaper.shape(Proportions::Zero()), after = reshaper.shape(proportions);
  // The skeleton at rest has its joints where the surface goes.
  const PosedSkeleton rest = forward_kinematics(after.skeleton, rest_pose(after.skeleton));
  for (int b = 0; b < kRigBoneCount; ++b)
    EXPECT_LT((rest.camera_from_bone[b].translation() - after.joints[b]).norm(), test::kMillimetreFloat) << b;
  const auto grown = [&](int from, int to) {
    return std::log((after.joints[to] - after.joints[from]).norm() / (before.joints[to] - before.joints[from]).norm());
  };
  EXPECT_NEAR(grown(kRigLeftHip, kRigLeftKnee), proportions[kThighLength], test::kDoubleExact);
  EXPECT_NEAR(grown(kRigRightKnee, kRigRightAnkle), proportions[kShankLength], test::kDoubleExact);
  EXPECT_NEAR(grown(kRigLeftShoulder, kRigLeftElbow), proportions[kUpperArmLength], test::kDoubleExact);
  EXPECT_NEAR(grown(kRigRightClavicle, kRigRightShoulder), proportions[kShoulderWidth], test::kDoubleExact);
}

TEST(Proportions, AGirthChangesWhatIsAroundItsBoneOnly) {
  const Actor& actor = test::builtin_actor("trousers");
  const Reshaper reshaper(actor);
  const Shape before = reshaper.shape(Proportions::Zero());
  const Shape after = reshaper.shape(0.1 * Proportions::Unit(kShankGirth));
  const Vector3d knee = before.joints[kRigLeftKnee], ankle = before.joints[kRigLeftAnkle];
  const Vector3d axis = (ankle - knee).normalized();
  int n_shank = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const Vector3d p = reshaper.vertex(before, i), q = reshaper.vertex(after, i);
    double left = 0, right = 0;
    for (int k = 0; k < kMaxInfluences; ++k) {
      const float weight = actor.skin.weights[4 * i + k];
      if (weight > 0 && actor.skin.bones[4 * i + k] == kRigLeftKnee) left += weight;
      if (weight > 0 && actor.skin.bones[4 * i + k] == kRigRightKnee) right += weight;
    }
    if (right > 0) continue;
    const Vector3d outwards = (p - knee) - axis * axis.dot(p - knee);
    EXPECT_LT((q - p - left * (std::exp(0.1) - 1) * outwards).norm(), test::kMillimetreFloat) << i;
    n_shank += left > 0.5;
  }
  EXPECT_GT(n_shank, 20);
}

}  // namespace
}  // namespace livecap
