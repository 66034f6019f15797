#include "pose/initialize.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "support/builtin_actor.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(Initialize, FindsAStandingPersonFromAnySide) {
  const Actor actor = test::make_test_actor(0.7);
  const Camera camera = test::portrait_camera();
  for (double facing : {0.0, 0.8, 1.6, 3.1, -1.2}) {
    const Pose truth = test::standing_pose(actor, facing);
    const Detections detections = test::exact_detections(actor, camera, truth, 0.8);
    const std::optional<Pose> pose = initialize_pose(actor, camera, detections, {});
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT((pose->root_rotation - truth.root_rotation).norm(), test::kTermResidual) << facing;
    EXPECT_LT(test::keypoint_distance_mm(actor, *pose, truth), test::kRecoveredMm) << facing;
  }
}

// The trunk is turned as a whole; arms and head are found all the same.
TEST(Initialize, LeavesTheChestAtRest) {
  const Actor& actor = test::builtin_actor("trousers");
  const Camera camera = test::portrait_camera();
  PoseOptions options;
  options.rebone = false;
  Pose truth = test::standing_pose(actor, 0.3);
  const auto turn = [&](const char* name, double rad) {
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
      if (actor.skeleton.dofs[k].name == name) truth.angles_rad[k] += rad;
  };
  turn("chest_y", 0.2);
  turn("left_shoulder_z", 0.9);
  turn("right_elbow_y", 0.8);
  turn("neck_y", -0.3);
  const auto pose = initialize_pose(actor, camera, test::exact_detections(actor, camera, truth), options);
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT(test::keypoint_distance_mm(actor, *pose, truth), test::kInitializedMm);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const Dof& dof = actor.skeleton.dofs[k];
    if (dof.name.starts_with("chest")) EXPECT_EQ(pose->angles_rad[k], dof.rest_rad) << dof.name;
  }
}

TEST(Initialize, StartsNearRandomPoses) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  PoseOptions options;
  options.rebone = false;
  std::mt19937 rng(4);
  for (int trial = 0; trial < 10; ++trial) {
    const Pose truth = test::random_true_pose(actor, rng, 0.9);
    const auto pose = initialize_pose(actor, camera, test::exact_detections(actor, camera, truth), options);
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT(test::keypoint_distance_mm(actor, *pose, truth), test::kInitializedMm) << trial;
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
      EXPECT_GE(pose->angles_rad[k], actor.skeleton.dofs[k].min_rad);
      EXPECT_LE(pose->angles_rad[k], actor.skeleton.dofs[k].max_rad);
    }
  }
}

TEST(Initialize, TooLittleToSeeIsNoPose) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  const Detections good = test::exact_detections(actor, camera, test::standing_pose(actor, 0));
  Detections nobody = good;
  nobody.person = false;
  EXPECT_FALSE(initialize_pose(actor, camera, nobody, {}).has_value());
  Detections no_torso = good;
  for (int k : {kLeftHip, kRightHip, kNeck, kLeftShoulder, kRightShoulder}) no_torso.keypoints[k].confidence = 0;
  EXPECT_FALSE(initialize_pose(actor, camera, no_torso, {}).has_value());
  Detections undefined = good;
  for (KeypointDetection& d : undefined.keypoints) d.x_mm = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(initialize_pose(actor, camera, undefined, {}).has_value());
  Detections one_place = good;
  for (KeypointDetection& d : one_place.keypoints) d.x_mm = d.y_mm = d.z_mm = 0;
  EXPECT_FALSE(initialize_pose(actor, camera, one_place, {}).has_value());
}

// Explicit Euler step: pose + (pose - previous), the root's rotation in its tangent space.
Pose extrapolate(const Pose& previous, const Pose& pose) {
  Eigen::VectorXd delta(6 + pose.angles_rad.size());
  delta.head<3>() = vector_from_rotation(pose.root_rotation * previous.root_rotation.transpose());
  delta.segment<3>(3) = pose.root_translation_mm - previous.root_translation_mm;
  delta.tail(pose.angles_rad.size()) = pose.angles_rad - previous.angles_rad;
  return add_increment(pose, delta);
}

TEST(Initialize, PredictionIsTheEulerStepWithinBounds) {
  const Actor actor = test::make_test_actor();
  std::mt19937 rng(6);
  PoseOptions options;
  const Pose before = test::random_true_pose(actor, rng, 0.3);
  const Pose now = test::disturbed(before, rng, 0.05, 20);
  const Pose expected = extrapolate(before, now);
  const Pose predicted = predict_pose(actor.skeleton, &before, now, options);
  EXPECT_LT(test::keypoint_distance_mm(actor, predicted, expected), test::kDoubleExact * 1000);
  EXPECT_EQ(test::keypoint_distance_mm(actor, predict_pose(actor.skeleton, nullptr, now, options), now), 0);

  // A leap is shortened, and limits are not left.
  Pose leap = now;
  leap.root_translation_mm.x() += 5000;
  leap.angles_rad[0] = actor.skeleton.dofs[0].max_rad - 0.01;
  Pose leap_before = leap;
  leap_before.root_translation_mm.x() -= 5000;
  leap_before.angles_rad[0] -= 1;
  const Pose bounded = predict_pose(actor.skeleton, &leap_before, leap, options);
  EXPECT_NEAR((bounded.root_translation_mm - leap.root_translation_mm).norm(), options.max_predicted_move_mm,
              test::kDoubleExact * 1000);
  EXPECT_NEAR(bounded.angles_rad[0], actor.skeleton.dofs[0].max_rad, test::kDoubleExact);
  Pose undefined = before;
  undefined.angles_rad[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(test::keypoint_distance_mm(actor, predict_pose(actor.skeleton, &undefined, now, options), now), 0);
}

}  // namespace
}  // namespace livecap
