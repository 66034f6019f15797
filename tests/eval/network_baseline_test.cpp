// The network's joints of a figure seen without error: they are where the figure's keypoints are.
#include "eval/network_baseline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "actor/actor.h"
#include "geometry/skeleton.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

struct Seen {
  Actor actor = load_actor_bytes(make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1500), "trousers");
  Camera camera = camera_from_fov(540, 960, 45);
  std::vector<Eigen::Vector3d> keypoints;  // camera frame
  Detections detections;

  // scale: of the network's 3D points, whose size does not matter.
  explicit Seen(double scale) {
    detections.person = true;
    const Eigen::Matrix3d upright = Eigen::Vector3d(1, -1, -1).asDiagonal();
    for (int k = 0; k < kKeypointCount; ++k) {
      const KeypointAnchor& anchor = actor.keypoints[k];
      keypoints.push_back(upright * anchor.rest_position_mm + Eigen::Vector3d(120, 800, 3500));
      if (anchor.bone < 0) continue;
      const Eigen::Vector3d& p = keypoints[k];
      const Eigen::Vector3d q = scale * upright * (anchor.rest_position_mm - actor.keypoints[kPelvis].rest_position_mm);
      detections.keypoints[k] = {static_cast<float>(camera.fx * p.x() / p.z() + camera.cx),
                                 static_cast<float>(camera.fy * p.y() / p.z() + camera.cy),
                                 static_cast<float>(q.x()),
                                 static_cast<float>(q.y()),
                                 static_cast<float>(q.z()),
                                 1};
    }
  }
};

TEST(NetworkBaseline, PlacesTheFigureByItsPicture) {
  const Seen seen(0.6);
  const std::vector<float> joints = network_joints(seen.actor, seen.camera, seen.detections);
  ASSERT_EQ(joints.size(), size_t(3) * kKeypointCount);
  ASSERT_EQ(network_joint_names().size(), size_t(kKeypointCount));
  EXPECT_EQ(network_joint_names()[kPelvis], "root");
  for (int k = 0; k < kBodyKeypointCount; ++k) {
    const Eigen::Vector3d joint(joints[3 * k], joints[3 * k + 1], joints[3 * k + 2]);
    EXPECT_LT((joint - seen.keypoints[k]).norm(), test::kRecoveredMm) << kKeypointNames[k];
  }
}

TEST(NetworkBaseline, UnknownPointsAreNotANumber) {
  Seen seen(1);
  seen.detections.keypoints[kLeftWrist].confidence = 0;
  const std::vector<float> joints = network_joints(seen.actor, seen.camera, seen.detections);
  ASSERT_FALSE(joints.empty());
  EXPECT_TRUE(std::isnan(joints[3 * kLeftWrist]));
  EXPECT_FALSE(std::isnan(joints[3 * kRightWrist]));
}

TEST(NetworkBaseline, NobodyHasNoJoints) {
  Seen seen(1);
  seen.detections.person = false;
  EXPECT_TRUE(network_joints(seen.actor, seen.camera, seen.detections).empty());
}

}  // namespace
}  // namespace livecap
