// Arms that the picture cannot have apart.
#include "pose/mirrored_arms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(MirroredArms, AMirroredForearmLooksTheSameFromTheCamera) {
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

// The left upper arm sideways and somewhat towards the camera, the forearm up and so too.
Pose with_left_arm(const Actor& actor, double forward_rad, double bend_rad) {
  Pose pose = test::standing_pose(actor, 0);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name == "left_shoulder_z") pose.angles_rad[k] = 0;
    if (name == "left_shoulder_y") pose.angles_rad[k] = -forward_rad;
    if (name == "left_shoulder_x") pose.angles_rad[k] = -1.0;
    if (name == "left_elbow_y") pose.angles_rad[k] = -bend_rad;
  }
  return pose;
}

// A picture of `truth` also shows `strayed`, whose bones are mirrored in depth where they are by as much.
TEST(MirroredArms, AnArmThatTheDetectionsSeeMirroredIsTried) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  PoseOptions options;
  options.rebone = false;
  const auto keypoints = [&](const Pose& p) {
    return keypoint_positions(actor, forward_kinematics(actor.skeleton, p));
  };
  const Pose strayed = with_left_arm(actor, 0.9, 1.0);
  const auto was = keypoints(strayed);
  const Eigen::Vector3d ray = was[kLeftElbow].normalized();
  const auto depth = [&](const auto& p, Keypoint from, Keypoint to) { return (p[to] - p[from]).normalized().dot(ray); };
  const double upper = depth(was, kLeftShoulder, kLeftElbow), lower = depth(was, kLeftElbow, kLeftWrist);
  ASSERT_GT(std::abs(upper), 0.4);
  ASSERT_GT(std::abs(lower), 0.4);
  // What the network would say of each of the four arms with this outline, as directions alone.
  const auto seen_as = [&](double upper_sign, double lower_sign) {
    Detections detections = test::exact_detections(actor, camera, strayed);
    const auto turned = [&](const Eigen::Vector3d& bone, double sign) -> Eigen::Vector3d {
      return bone + (sign - 1) * bone.dot(ray) * ray;
    };
    const Eigen::Vector3d elbow = was[kLeftShoulder] + turned(was[kLeftElbow] - was[kLeftShoulder], upper_sign);
    const Eigen::Vector3d wrist = elbow + turned(was[kLeftWrist] - was[kLeftElbow], lower_sign);
    for (const auto& [k, p] : {std::pair{kLeftElbow, elbow}, {kLeftWrist, wrist}}) {
      KeypointDetection& seen = detections.keypoints[k];
      const Eigen::Vector3d moved = p - was[k];
      seen.x_mm += float(moved.x());
      seen.y_mm += float(moved.y());
      seen.z_mm += float(moved.z());
    }
    return detections;
  };
  const auto tried = [&](const Detections& detections, MirroredArmOptions mirrored = {}) {
    return mirrored_arms(actor, strayed, kLeftElbow, detections, options, mirrored);
  };
  EXPECT_TRUE(tried(seen_as(1, 1)).empty());
  for (const auto& [upper_sign, lower_sign] : {std::pair{-1.0, 1.0}, {1.0, -1.0}, {-1.0, -1.0}}) {
    const std::vector<Pose> poses = tried(seen_as(upper_sign, lower_sign));
    ASSERT_FALSE(poses.empty()) << upper_sign << lower_sign;
    bool found = false;
    for (const Pose& pose : poses) {
      const auto is = keypoints(pose);
      for (int k = 0; k < kKeypointCount; ++k)
        if (k != kLeftElbow && k != kLeftWrist && k != kLeftHand) EXPECT_LT((is[k] - was[k]).norm(), 1e-6) << k;
      found |= depth(is, kLeftShoulder, kLeftElbow) * upper * upper_sign > 0 &&
               depth(is, kLeftElbow, kLeftWrist) * lower * lower_sign > 0 &&
               (project_px(camera, is[kLeftElbow]) - project_px(camera, was[kLeftElbow])).norm() < test::kMirroredPx &&
               (project_px(camera, is[kLeftWrist]) - project_px(camera, was[kLeftWrist])).norm() < test::kMirroredPx;
    }
    EXPECT_TRUE(found) << upper_sign << lower_sign;
  }
  const Detections mirrored = seen_as(-1, -1);
  EXPECT_TRUE(tried(mirrored, {.least_difference = 8.1}).empty()) << "unit vectors differ by at most 2 each";
  EXPECT_EQ(tried(mirrored, {.largest_share = 1e-3}).size(), 1u) << "the others explain half of it";
  EXPECT_EQ(tried(mirrored, {.largest_share = 1.0}).size(), 3u);
  for (Keypoint k : {kLeftShoulder, kLeftElbow, kLeftWrist}) {
    Detections unsure = mirrored;
    unsure.keypoints[k].confidence = 0.3f;
    EXPECT_TRUE(tried(unsure).empty()) << k;
  }
}

}  // namespace
}  // namespace livecap
