// Cloth in folds that legs carry.
#include "cloth/folded_cloth.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <utility>

#include "cloth/hanging_cloth.h"
#include "cloth/scene.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector3f;

Pose far_away(const Actor& actor) {
  Pose pose = test::pose_of(actor.skeleton, -0.6);
  pose.root_translation_mm.z() = 3000;
  return pose;
}

// The skirt with a lining: itself once more, turned inside out.
Actor lined(Actor actor) {
  const int n = actor.n_vertices(), n_triangles = actor.mesh.n_triangles();
  const auto twice = [](auto& values) {
    const auto once = values;
    values.insert(values.end(), once.begin(), once.end());
  };
  twice(actor.mesh.positions);
  twice(actor.skin.bones);
  twice(actor.skin.weights);
  twice(actor.rigidity);
  twice(actor.mesh.triangles);
  for (int t = n_triangles; t < 2 * n_triangles; ++t) {
    int32_t* corners = &actor.mesh.triangles[3 * t];
    for (int k = 0; k < 3; ++k) corners[k] += n;
    std::swap(corners[0], corners[1]);
  }
  return actor;
}

// The left leg is lifted forward; the pelvis stays. Against the formula with Eigen, for every vertex; a lining goes
// with the cloth it lies on.
TEST(FoldedCloth, GoesWithLegsThatPushItAndStaysWhereTheyLeaveIt) {
  const Actor actor = lined(test::skirt_actor());
  const int n = actor.n_vertices();
  constexpr float kOpening = 0.7f;
  const HangingCloth hanging(actor, {.carried_power = 1});
  const std::vector<float> quats =
      hanging.dual_quats(forward_kinematics(actor.skeleton, far_away(actor)), -Eigen::Vector3d::UnitY());
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    Skinner carrying(device, actor, hanging.weights(), actor.skeleton.n_bones() + 1);
    Skinner hanging_down(device, actor, hanging.hung_weights(), actor.skeleton.n_bones() + 1);
    ocl::Buffer<float> zero(device, size_t(3) * n), carried(device, size_t(3) * n), hung(device, size_t(3) * n),
        normals(device, size_t(3) * n);
    zero.fill(0);
    carrying.set_pose(quats);
    carrying.skin(zero, carried);
    carrying.normals(carried, normals);
    hanging_down.set_pose(quats);
    hanging_down.skin(zero, hung);
    const std::vector<float> p1 = carried.read_all(), p0 = hung.read_all(), normal = normals.read_all();
    std::vector<float> displaced = p1;
    std::mt19937 random(7);
    for (float& value : displaced) value += std::uniform_real_distribution<float>(-30, 30)(random);
    ocl::Buffer<float> start(device, displaced), before(device, p1);

    FoldedCloth folds(device, actor, hanging.hung_weights(), kOpening);
    folds.open(quats, normals, carried, start, before);

    const std::vector<float> got = carried.read_all(), moved = start.read_all(), moved_before = before.read_all();
    double most_pushed = 0, most_left = 0;
    for (int i = 0; i < n; ++i) {
      const Vector3f from(&p0[3 * i]), to(&p1[3 * i]), d = to - from;
      const Vector3f outwards(&normal[3 * (i % (n / 2))]);
      const float cosine = d.norm() > 0 ? d.normalized().dot(outwards) : 0;
      const Vector3f known = from + (1 - kOpening * (1 - cosine) / 2) * d;
      EXPECT_LT((Vector3f(&got[3 * i]) - known).norm(), test::kFoldedClothMm) << i;
      EXPECT_LT((Vector3f(&moved[3 * i]) - (Vector3f(&displaced[3 * i]) + known - to)).norm(), test::kFoldedClothMm);
      EXPECT_LT((Vector3f(&moved_before[3 * i]) - known).norm(), test::kFoldedClothMm);
      if (cosine > 0.6) most_pushed = std::max<double>(most_pushed, (known - from).norm());
      if (cosine < -0.6) most_left = std::max<double>(most_left, (known - from).norm());
    }
    EXPECT_GT(most_pushed, 100) << "the front goes with the thigh";
    EXPECT_GT(most_left, 10);
    EXPECT_LT(most_left, 0.6 * most_pushed) << "the back does not";
  });
}

}  // namespace
}  // namespace livecap
