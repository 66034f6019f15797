#include "actor/posed_vertices.h"

#include <gtest/gtest.h>

#include "support/test_actor.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(PosedVertices, RestIsTheTemplate) {
  const Actor actor = test::make_test_actor(0.6);
  const std::vector<float> posed =
      posed_vertices(actor, bone_dual_quats(forward_kinematics(actor.skeleton, rest_pose(actor.skeleton))));
  ASSERT_EQ(posed.size(), actor.mesh.positions.size());
  for (size_t i = 0; i < posed.size(); ++i) EXPECT_NEAR(posed[i], actor.mesh.positions[i], test::kMillimetreFloat);
}

TEST(PosedVertices, AVertexOfOneBoneMovesWithIt) {
  const Actor actor = test::make_test_actor();
  Pose pose = rest_pose(actor.skeleton);
  for (int k = 0; k < pose.angles_rad.size(); ++k) pose.angles_rad[k] += 0.3 * std::sin(k + 1.0);
  pose.root_rotation = rotation_from_vector({0.4, -1.1, 0.7});
  pose.root_translation_mm = {120, -340, 2900};
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
  const std::vector<float> vertices = posed_vertices(actor, bone_dual_quats(posed));
  int n = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    if (actor.skin.weights[4 * i] < 1) continue;
    const Eigen::Vector3d rest = Eigen::Vector3f::Map(&actor.mesh.positions[3 * i]).cast<double>();
    const Eigen::Vector3d expected = posed.camera_from_rest[actor.skin.bones[4 * i]] * rest;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(vertices[3 * i + k], expected[k], test::kMillimetreFloat);
    ++n;
  }
  EXPECT_GT(n, actor.n_vertices() / 2);
}

}  // namespace
}  // namespace livecap
