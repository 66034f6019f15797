#include "pose/rebone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

double template_length(const Actor& actor, int a, int b) {
  return (actor.keypoints[a].rest_position_mm - actor.keypoints[b].rest_position_mm).norm();
}

TEST(Rebone, KeepsDirectionsAndTakesTheTemplatesLengths) {
  const Actor actor = test::make_test_actor(0.5);
  std::mt19937 rng(1);
  const Pose pose = test::random_true_pose(actor, rng, 0.7);
  Detections detections = test::exact_detections(actor, test::portrait_camera(), pose, 0.6);
  // A network with other proportions.
  detections.keypoints[kLeftWrist].x_mm += 80;
  const Keypoints3d points = rebone(actor, detections);
  for (int k = 0; k < kKeypointCount; ++k) {
    if (k == kPelvis) continue;
    const int parent = keypoint_parent(k);
    const Eigen::Vector3d bone = points[k].position_mm - points[parent].position_mm;
    EXPECT_NEAR(bone.norm(), template_length(actor, k, parent), test::kDoubleExact * 1000) << kKeypointNames[k];
    const KeypointDetection& to = detections.keypoints[k];
    const KeypointDetection& from = detections.keypoints[parent];
    const Eigen::Vector3d detected(double(to.x_mm) - from.x_mm, double(to.y_mm) - from.y_mm,
                                   double(to.z_mm) - from.z_mm);
    EXPECT_NEAR(bone.normalized().dot(detected.normalized()), 1, test::kDoubleExact) << kKeypointNames[k];
    EXPECT_EQ(points[k].confidence, 1);
  }
  EXPECT_EQ(points[kPelvis].position_mm.norm(), 0);
}

TEST(Rebone, ScaleOfTheDetectionsDoesNotMatter) {
  const Actor actor = test::make_test_actor();
  std::mt19937 rng(2);
  const Pose pose = test::random_true_pose(actor, rng, 0.7);
  const Keypoints3d small = rebone(actor, test::exact_detections(actor, test::portrait_camera(), pose, 0.25));
  const Keypoints3d large = rebone(actor, test::exact_detections(actor, test::portrait_camera(), pose, 4));
  for (int k = 0; k < kKeypointCount; ++k)
    EXPECT_LT((small[k].position_mm - large[k].position_mm).norm(), test::kTermResidual);
}

TEST(Rebone, ConfidenceIsTheLeastOnTheWayFromThePelvis) {
  const Actor actor = test::make_test_actor();
  Detections detections = test::exact_detections(actor, test::portrait_camera(), test::standing_pose(actor, 0));
  detections.keypoints[kLeftElbow].confidence = 0.25f;
  detections.keypoints[kRightKnee].confidence = 0;
  detections.keypoints[kNose].z_mm = std::numeric_limits<float>::quiet_NaN();
  detections.keypoints[kPelvis].confidence = 0;
  const Keypoints3d points = rebone(actor, detections);
  EXPECT_EQ(points[kLeftShoulder].confidence, 1);
  EXPECT_EQ(points[kLeftHand].confidence, 0.25);
  EXPECT_EQ(points[kRightHip].confidence, 1);
  EXPECT_EQ(points[kRightToe].confidence, 0);
  EXPECT_EQ(points[kNose].confidence, 0);
  EXPECT_EQ(points[kPelvis].confidence, 0);
  for (const Keypoint3d& point : points) EXPECT_TRUE(point.position_mm.allFinite());
}

TEST(Rebone, AnActorWithoutAnAnchorHangsTheChildrenOnItsParent) {
  Actor actor = test::make_test_actor();
  actor.keypoints[kLeftElbow].bone = -1;
  const Detections detections =
      test::exact_detections(test::make_test_actor(), test::portrait_camera(), test::standing_pose(actor, 0), 0.5);
  const Keypoints3d points = rebone(actor, detections);
  EXPECT_EQ(points[kLeftElbow].confidence, 0);
  EXPECT_NEAR((points[kLeftWrist].position_mm - points[kLeftShoulder].position_mm).norm(),
              template_length(actor, kLeftWrist, kLeftShoulder), test::kDoubleExact * 1000);
}

TEST(Rebone, NobodyMeansNothingIsKnown) {
  const Actor actor = test::make_test_actor();
  Detections detections = test::exact_detections(actor, test::portrait_camera(), test::standing_pose(actor, 0));
  detections.person = false;
  for (const Keypoint3d& point : rebone(actor, detections)) EXPECT_EQ(point.confidence, 0);
  for (const Keypoint3d& point : keypoints_3d(actor, detections)) EXPECT_EQ(point.confidence, 0);
}

}  // namespace
}  // namespace livecap
