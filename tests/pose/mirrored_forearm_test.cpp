// Forearms that the picture cannot tell from their mirror images in depth.
#include "pose/mirrored_forearm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(MirroredForearm, LooksTheSameFromTheCamera) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  Pose pose = test::standing_pose(actor, 0);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    // The left upper arm sideways, its forearm up and towards the camera.
    if (name == "left_shoulder_z") pose.angles_rad[k] = 0;
    if (name == "left_shoulder_x") pose.angles_rad[k] = -1.15;
    if (name == "left_elbow_y") pose.angles_rad[k] = -1.5;
  }
  const auto keypoints = [&](const Pose& p) {
    return keypoint_positions(actor, forward_kinematics(actor.skeleton, p));
  };
  const auto before = keypoints(pose);
  const auto mirrored = mirrored_forearm(actor, pose, kLeftElbow, 0.35);
  ASSERT_TRUE(mirrored.has_value());
  EXPECT_EQ(mirrored->bone, actor.skeleton.bone_index("left_elbow"));
  const auto after = keypoints(with_mirrored_forearm(actor, pose, *mirrored));
  EXPECT_LT((project_px(camera, after[kLeftWrist]) - project_px(camera, before[kLeftWrist])).norm(), test::kMirroredPx);
  EXPECT_LT((after[kLeftElbow] - before[kLeftElbow]).norm(), 1);
  const Eigen::Vector3d was = before[kLeftWrist] - before[kLeftElbow], is = after[kLeftWrist] - after[kLeftElbow];
  EXPECT_LT(was.z(), -80);
  EXPECT_GT(is.z(), was.z() + 80);
  EXPECT_LT((mirrored->turn * was - is).norm(), test::kMirroredMm);
  for (int k = 0; k < kKeypointCount; ++k) {
    if (k != kLeftElbow && k != kLeftWrist && k != kLeftHand) EXPECT_EQ(after[k], before[k]) << k;
  }
  const double angle = Eigen::AngleAxisd(mirrored->turn).angle();
  EXPECT_TRUE(mirrored_forearm(actor, pose, kLeftElbow, 0.99 * angle).has_value());
  EXPECT_FALSE(mirrored_forearm(actor, pose, kLeftElbow, 1.01 * angle).has_value());
}

}  // namespace
}  // namespace livecap
