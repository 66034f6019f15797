// What counts otherwise of an actor whose skirt hides the knees.
#include "capture/pose_shares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "actor/labels.h"
#include "capture/components.h"
#include "support/builtin_actor.h"

namespace livecap {
namespace {

// The built-in skirt, let down.
Actor in_a_skirt(float longer_mm) {
  Actor actor = test::builtin_actor("skirt");
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i)) actor.mesh.positions[3 * i + 1] -= longer_mm;
  return actor;
}

TEST(PoseShares, TellsHowFarASkirtCoversTheKnees) {
  const double as_it_is = knee_cover_mm(in_a_skirt(0));
  EXPECT_LT(as_it_is, 0) << "the built-in skirt ends above the knees";
  EXPECT_GT(as_it_is, -100);
  EXPECT_NEAR(knee_cover_mm(in_a_skirt(250)) - as_it_is, 250, 1e-3);
  EXPECT_TRUE(std::isinf(knee_cover_mm(test::builtin_actor("trousers"))));
  Actor jumpsuit = in_a_skirt(250);
  for (uint8_t& label : jumpsuit.labels)
    if (label == lip::kSkirt) label = 10;
  EXPECT_TRUE(std::isinf(knee_cover_mm(jumpsuit))) << "its knees are seen";
  Actor no_knee = in_a_skirt(250);
  no_knee.keypoints[kLeftKnee].bone = -1;
  EXPECT_TRUE(std::isinf(knee_cover_mm(no_knee)));
}

TEST(PoseShares, KneesThatClothHidesAreGuessedInThePicture) {
  const TrackerOptions given;
  const auto& told = given.pose.keypoint_2d_weights;
  for (const Actor& actor : {in_a_skirt(0), test::builtin_actor("trousers")}) {
    const TrackerOptions options = options_for(actor, given);
    EXPECT_EQ(options.pose.keypoint_2d_weights, told);
    EXPECT_EQ(options.rounds.refined_doubt_3d_mm, given.rounds.refined_doubt_3d_mm);
    EXPECT_EQ(options.pose.least_stands, given.pose.least_stands);
    EXPECT_EQ(options.floor.balance.share, given.floor.balance.share);
  }
  const TrackerOptions options = options_for(in_a_skirt(250), given);
  for (int k = 0; k < kKeypointCount; ++k) {
    const double share = k == kLeftKnee || k == kRightKnee ? given.hidden_knees.keypoint_2d : 1;
    EXPECT_DOUBLE_EQ(options.pose.keypoint_2d_weights[k], share * told[k]) << k;
  }
  EXPECT_EQ(options.rounds.refined_doubt_3d_mm, given.hidden_knees.refined_doubt_3d_mm);
  EXPECT_EQ(options.pose.least_stands, given.hidden_knees.least_stands);
  EXPECT_EQ(options.floor.balance.share, given.hidden_knees.balance_share);
  TrackerOptions unbalanced = given;
  switch_off("balance", unbalanced);
  EXPECT_EQ(options_for(in_a_skirt(250), unbalanced).floor.balance.share, 0);
  TrackerOptions stands = given;
  stands.pose.least_stands = 0.4;
  EXPECT_EQ(options_for(in_a_skirt(250), stands).pose.least_stands, 0.4) << "what is given is more";
}

}  // namespace
}  // namespace livecap
