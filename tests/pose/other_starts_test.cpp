// The poses that stage I also tries when a pattern, or the other shoe, may have led it astray.
#include "pose/other_starts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "livecap/error.h"
#include "support/builtin_actor.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

PoseOptions as_detected() {
  PoseOptions options;
  options.rebone = false;
  return options;
}

double facing_rad(const Pose& from, const Pose& to) {
  return vector_from_rotation(to.root_rotation * from.root_rotation.transpose()).norm();
}

TEST(OtherStarts, ATrunkIsTurnedToWhereTheDetectionsFace) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  for (const double facing : {-0.9, -0.3, 0.3, 2.9}) {
    const Pose truth = test::standing_pose(actor, facing);
    const Pose strayed = test::standing_pose(actor, facing + 0.35);
    const Detections detections = test::exact_detections(actor, camera, truth);
    const auto turned = turned_trunk(actor, strayed, detections, as_detected(), 0.21);
    ASSERT_TRUE(turned.has_value()) << facing;
    EXPECT_LT(facing_rad(*turned, truth), test::kTurnedTrunkRad) << facing;
    EXPECT_EQ(turned->root_translation_mm, strayed.root_translation_mm);
    EXPECT_FALSE(turned_trunk(actor, strayed, detections, as_detected(), 0.5).has_value()) << facing;
  }
}

// A twist between hips and shoulders is no trunk that faces elsewhere.
TEST(OtherStarts, ATwistedTrunkIsLeftAlone) {
  const Actor& actor = test::builtin_actor("trousers");
  Pose twisted = test::standing_pose(actor, 0.3);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "chest_y") twisted.angles_rad[k] = 0.7;
  const Detections detections = test::exact_detections(actor, test::portrait_camera(), twisted);
  EXPECT_FALSE(turned_trunk(actor, twisted, detections, as_detected(), 0.1).has_value());
  Pose strayed = twisted;
  strayed.root_rotation = rotation_from_vector(Eigen::Vector3d(0, 0.3, 0)) * twisted.root_rotation;
  const auto turned = turned_trunk(actor, strayed, detections, as_detected(), 0.21);
  ASSERT_TRUE(turned.has_value());
  EXPECT_LT(facing_rad(*turned, twisted), test::kTurnedTrunkRad);
}

// Network depth leans whole bodies; that is not what this is about.
TEST(OtherStarts, ALeanIsLeftAlone) {
  const Actor actor = test::make_test_actor();
  const Pose upright = test::standing_pose(actor, 0.4);
  Pose leaning = upright;
  leaning.root_rotation = rotation_from_vector(Eigen::Vector3d(0.5, 0, 0)) * upright.root_rotation;
  const Detections detections = test::exact_detections(actor, test::portrait_camera(), upright);
  EXPECT_FALSE(turned_trunk(actor, leaning, detections, as_detected(), 0.21).has_value());
  Detections nobody = detections;
  nobody.person = false;
  EXPECT_FALSE(turned_trunk(actor, test::standing_pose(actor, 1.4), nobody, as_detected(), 0.21).has_value());
}

TEST(OtherStarts, OnlyALegFarFromItsAnkleIsBentAnew) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  const Pose truth = test::standing_pose(actor, 0);
  const Detections detections = test::exact_detections(actor, camera, truth);
  Pose strayed = truth;
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name == "left_hip_z") strayed.angles_rad[k] += 0.4;
    if (name == "right_knee_x" || name == "left_shoulder_z") strayed.angles_rad[k] += 0.05;
  }
  EXPECT_FALSE(with_detected_legs(actor, camera, truth, detections, as_detected(), 20).has_value());
  const auto bent = with_detected_legs(actor, camera, strayed, detections, as_detected(), 20);
  ASSERT_TRUE(bent.has_value());
  const auto keypoints = [&](const Pose& pose) {
    return keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  };
  EXPECT_GT((keypoints(strayed)[kLeftAnkle] - keypoints(truth)[kLeftAnkle]).norm(), 100);
  EXPECT_LT((keypoints(*bent)[kLeftAnkle] - keypoints(truth)[kLeftAnkle]).norm(), test::kInitializedMm);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name.starts_with("left_hip") || name.starts_with("left_knee") || name.starts_with("left_ankle")) continue;
    EXPECT_EQ(bent->angles_rad[k], strayed.angles_rad[k]) << name;
  }
  Detections unsure = detections;
  unsure.keypoints[kLeftAnkle].confidence = 0.3f;
  EXPECT_FALSE(with_detected_legs(actor, camera, strayed, unsure, as_detected(), 20).has_value());
}

// Elbows and knees; shoulders have three angles and wrap round.
TEST(OtherStarts, HingesPastTheirLimitAreBentBack) {
  const Skeleton skeleton = test::make_test_actor().skeleton;
  const auto angle = [&](Pose& pose, const std::string& name) -> double& {
    for (int k = 0; k < skeleton.n_dofs(); ++k)
      if (skeleton.dofs[k].name == name) return pose.angles_rad[k];
    throw LogicError(name);
  };
  constexpr double kDegree = std::numbers::pi / 180, kLeast = 7 * kDegree;
  Pose pose = test::standing_pose(test::make_test_actor(), 0);
  angle(pose, "left_elbow_y") = 8 * kDegree;    // to 2
  angle(pose, "right_elbow_y") = 40 * kDegree;  // from -2
  angle(pose, "right_knee_x") = -9 * kDegree;   // from -5
  angle(pose, "left_shoulder_x") = 170 * kDegree;
  EXPECT_FALSE(with_hinges_bent_back(skeleton, pose, kLeast).has_value());

  Pose strayed = pose;
  angle(strayed, "left_elbow_y") = 24 * kDegree;
  angle(strayed, "right_knee_x") = -25 * kDegree;
  auto bent = with_hinges_bent_back(skeleton, strayed, kLeast);
  ASSERT_TRUE(bent.has_value());
  EXPECT_NEAR(angle(*bent, "left_elbow_y"), -20 * kDegree, test::kWeightSum);
  EXPECT_NEAR(angle(*bent, "right_knee_x"), 15 * kDegree, test::kWeightSum);
  angle(*bent, "left_elbow_y") = angle(strayed, "left_elbow_y");
  angle(*bent, "right_knee_x") = angle(strayed, "right_knee_x");
  EXPECT_EQ(bent->angles_rad, strayed.angles_rad);
  EXPECT_EQ(bent->root_rotation, strayed.root_rotation);
  EXPECT_EQ(bent->root_translation_mm, strayed.root_translation_mm);

  // Never past the other limit.
  angle(strayed, "left_elbow_y") = 178 * kDegree;
  bent = with_hinges_bent_back(skeleton, strayed, kLeast);
  ASSERT_TRUE(bent.has_value());
  EXPECT_NEAR(angle(*bent, "left_elbow_y"), -150 * kDegree, test::kWeightSum);
}

// The same arm has two sets of angles: Rz(a) Ry(b) Rx(c) = Rz(a - pi) Ry(pi - b) Rx(c - pi). One that left its limits
// on the far side is led to where it is by angles within them.
TEST(OtherStarts, AnArmPastItsLimitsIsLedToTheSamePlaceWithinThem) {
  const Actor actor = test::make_test_actor();
  const Skeleton& skeleton = actor.skeleton;
  const auto index = [&](const std::string& name) {
    for (int k = 0; k < skeleton.n_dofs(); ++k)
      if (skeleton.dofs[k].name == name) return k;
    throw LogicError(name);
  };
  const auto keypoints = [&](const Pose& pose) {
    return keypoint_positions(actor, forward_kinematics(skeleton, pose));
  };
  const int a = index("left_shoulder_z"), b = index("left_shoulder_y"), c = index("left_shoulder_x");
  Pose pose = test::standing_pose(actor, 0.3);
  pose.angles_rad[a] = -1.2;
  pose.angles_rad[b] = -0.5;
  pose.angles_rad[c] = 0.4;
  pose.angles_rad[index("left_elbow_y")] = -0.9;
  constexpr double kLeast = 0.015;
  EXPECT_FALSE(with_arms_within_limits(actor, pose, kLeast).has_value());
  Pose strayed = pose;
  strayed.angles_rad[a] += std::numbers::pi;
  strayed.angles_rad[b] = -std::numbers::pi - pose.angles_rad[b];
  strayed.angles_rad[c] -= std::numbers::pi;
  const auto was = keypoints(strayed);
  ASSERT_LT((was[kLeftWrist] - keypoints(pose)[kLeftWrist]).norm(), test::kLedArmMm) << "the test's own algebra";
  ASSERT_GT(strayed.angles_rad[a], skeleton.dofs[a].max_rad);

  const auto bent = with_arms_within_limits(actor, strayed, kLeast);
  ASSERT_TRUE(bent.has_value());
  const auto is = keypoints(*bent);
  EXPECT_LT((is[kLeftElbow] - was[kLeftElbow]).norm(), test::kLedArmMm);
  EXPECT_LT((is[kLeftWrist] - was[kLeftWrist]).norm(), test::kLedArmMm);
  for (int k = 0; k < skeleton.n_dofs(); ++k) {
    const Dof& dof = skeleton.dofs[k];
    EXPECT_GE(bent->angles_rad[k], dof.min_rad) << dof.name;
    EXPECT_LE(bent->angles_rad[k], dof.max_rad) << dof.name;
    if (!dof.name.starts_with("left_shoulder") && !dof.name.starts_with("left_elbow"))
      EXPECT_EQ(bent->angles_rad[k], strayed.angles_rad[k]) << dof.name;
  }
  // A collarbone that was pushed along goes back to rest; the arm reaches as far as its length lets it.
  strayed.angles_rad[index("left_clavicle_y")] = -0.4;
  const auto rested = with_arms_within_limits(actor, strayed, kLeast);
  ASSERT_TRUE(rested.has_value());
  EXPECT_EQ(rested->angles_rad[index("left_clavicle_y")], skeleton.dofs[index("left_clavicle_y")].rest_rad);

  // So far past as was asked for, and no less.
  Pose slightly = pose;
  slightly.angles_rad[a] = skeleton.dofs[a].max_rad + 0.9 * kLeast;
  EXPECT_FALSE(with_arms_within_limits(actor, slightly, kLeast).has_value());
  slightly.angles_rad[a] = skeleton.dofs[a].max_rad + 1.1 * kLeast;
  EXPECT_TRUE(with_arms_within_limits(actor, slightly, kLeast).has_value());
}

}  // namespace
}  // namespace livecap
