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

// Of dual quaternions weighted in Eigen, each with the sign of the first one's half.
TEST(PosedVertices, BonesShareAVertexByItsWeights) {
  const Actor actor = test::make_test_actor();
  int n = 0, n_turned = 0;  // weights; those of the other sign
  for (int axis = 0; axis < 3; ++axis) {
    Pose pose = rest_pose(actor.skeleton);
    for (int k = 0; k < pose.angles_rad.size(); ++k) pose.angles_rad[k] += 0.5 * std::sin(k + 2.0);
    pose.root_rotation = rotation_from_vector(3.1 * Eigen::Vector3d::Unit(axis));
    std::vector<float> quats = bone_dual_quats(forward_kinematics(actor.skeleton, pose));
    for (int bone = 1; bone < actor.skeleton.n_bones(); bone += 2)  // the same motion, told by the other half
      for (int k = 0; k < 8; ++k) quats[8 * bone + k] *= -1;
    const std::vector<float> vertices = posed_vertices(actor, quats);
    for (int i = 0; i < actor.n_vertices(); ++i) {
      Eigen::Vector4d real = Eigen::Vector4d::Zero(), dual = Eigen::Vector4d::Zero();
      const float* first = &quats[8 * actor.skin.bones[4 * i]];
      for (int k = 0; k < 4; ++k) {
        const float* q = &quats[8 * actor.skin.bones[4 * i + k]];
        const bool turned = Eigen::Vector4f::Map(first).dot(Eigen::Vector4f::Map(q)) < 0;
        const double w = actor.skin.weights[4 * i + k] * (turned ? -1 : 1);
        real += w * Eigen::Vector4f::Map(q).cast<double>();
        dual += w * Eigen::Vector4f::Map(q + 4).cast<double>();
        n += w != 0;
        n_turned += w < 0;
      }
      const Eigen::Quaterniond r = Eigen::Quaterniond(real[0], real[1], real[2], real[3]).normalized();
      dual /= real.norm();
      const Eigen::Quaterniond d(dual[0], dual[1], dual[2], dual[3]);
      const Eigen::Vector3d rest = Eigen::Vector3f::Map(&actor.mesh.positions[3 * i]).cast<double>();
      const Eigen::Vector3d expected = r * rest + 2 * (d * r.conjugate()).vec();
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(vertices[3 * i + k], expected[k], test::kMillimetreFloat) << i;
    }
  }
  EXPECT_GT(n, 3 * actor.n_vertices()) << "some have several";
  EXPECT_GT(n_turned, 0);
}

}  // namespace
}  // namespace livecap
