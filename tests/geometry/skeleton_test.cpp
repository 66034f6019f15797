#include "geometry/skeleton.h"

#include <gtest/gtest.h>

#include <random>

#include "geometry/reference.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A small branching chain with every kind of axis.
Skeleton branching_chain() {
  Skeleton s;
  s.bones = {{"root", -1, {0, 0, 0}}, {"arm", 0, {100, 400, 10}}, {"hand", 1, {250, 0, 5}}, {"leg", 0, {80, -60, 0}}};
  s.dofs = {{"arm_z", 1, {0, 0, 1}, -2, 2, -0.4},
            {"arm_y", 1, {0, 1, 0}, -2, 2, 0.1},
            {"hand_y", 2, {0, 1, 0}, -2, 2, 0},
            {"leg_x", 3, {1, 0, 0}, -2, 2, 0.05}};
  s.root_rest_mm = {3, 900, -7};
  return s;
}

Pose random_pose(const Skeleton& s, std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Pose pose;
  pose.root_rotation = rotation_from_vector(Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)) * 2);
  pose.root_translation_mm = {200 * uniform(rng), 200 * uniform(rng), 3000 + 500 * uniform(rng)};
  pose.angles_rad = Eigen::VectorXd::NullaryExpr(s.n_dofs(), [&] { return uniform(rng); });
  return pose;
}

TEST(Skeleton, RestPoseLeavesTheTemplateWhereItIs) {
  const Skeleton s = branching_chain();
  s.validate();
  for (const auto& motion : forward_kinematics(s, rest_pose(s)).camera_from_rest)
    EXPECT_LT((motion.matrix() - Eigen::Matrix4d::Identity()).norm(), test::kDoubleExact);
}

TEST(Skeleton, IncrementsMatchFiniteDifferencesOfBonePoints) {
  const Skeleton s = branching_chain();
  std::mt19937 rng(7);
  const auto masks = dofs_moving_bones(s);
  const double h = 1e-5;
  for (int trial = 0; trial < 5; ++trial) {
    const Pose pose = random_pose(s, rng);
    const PosedSkeleton posed = forward_kinematics(s, pose);
    const Eigen::Vector3d rest_point(150, 1200, 40);
    for (int b = 0; b < s.n_bones(); ++b) {
      const Eigen::Vector3d p = posed.camera_from_rest[b] * rest_point;
      for (int column = 0; column < 6 + s.n_dofs(); ++column) {
        Eigen::VectorXd delta = Eigen::VectorXd::Zero(6 + s.n_dofs());
        delta[column] = h;
        const Eigen::Vector3d plus = forward_kinematics(s, add_increment(pose, delta)).camera_from_rest[b] * rest_point;
        const Eigen::Vector3d minus =
            forward_kinematics(s, add_increment(pose, -delta)).camera_from_rest[b] * rest_point;
        Eigen::Vector3d expected;
        if (column < 3) {
          expected = Eigen::Vector3d::Unit(column).cross(p - pose.root_translation_mm);
        } else if (column < 6) {
          expected = Eigen::Vector3d::Unit(column - 3);
        } else {
          const int k = column - 6;
          expected = (masks[b] >> k & 1) ? posed.dof_axis[k].cross(p - posed.dof_origin_mm[k]).eval()
                                         : Eigen::Vector3d::Zero().eval();
        }
        EXPECT_LT(((plus - minus) / (2 * h) - expected).norm(),
                  test::kFiniteDifference * std::max(1.0, expected.norm()))
            << "bone " << b << " column " << column;
      }
    }
  }
}

// Dual quaternion skinning of one vertex with three bones, and its derivative by every unknown.
TEST(Skeleton, DualQuaternionSkinningDerivativeMatchesFiniteDifferences) {
  using namespace reference;
  const Skeleton s = branching_chain();
  std::mt19937 rng(3);
  const auto masks = dofs_moving_bones(s);
  const double weights[] = {0.5, 0.2, 0.3, 0.0};
  const Vec3 rest = vec3(260, 1290, 30);

  auto bone_quat = [&](const PosedSkeleton& posed, int b) {
    const auto& motion = posed.camera_from_rest[b];
    const Eigen::Quaterniond q(motion.linear());
    const Eigen::Vector3d t = motion.translation() / 2;
    const Eigen::Quaterniond d = Eigen::Quaterniond(0, t.x(), t.y(), t.z()) * q;
    return DualQuat{q.w(), q.x(), q.y(), q.z(), d.w(), d.x(), d.y(), d.z()};
  };
  // Blend of the bones selected by `use`, signs aligned with bone 0 of the full blend.
  auto blend = [&](const PosedSkeleton& posed, auto&& use) {
    DualQuat sum = dual_quat_zero();
    const DualQuat first = bone_quat(posed, 0);
    for (int b = 0; b < 4; ++b) {
      const DualQuat q = bone_quat(posed, b);
      const double sign = dual_quat_real_dot(first, q) < 0 ? -1 : 1;
      if (use(b)) sum = dual_quat_add_scaled(sum, q, sign * weights[b]);
    }
    return sum;
  };
  auto skin = [&](const Pose& pose) {
    const PosedSkeleton posed = forward_kinematics(s, pose);
    const Vec3 v = dual_quat_transform(blend(posed, [](int) { return true; }), rest);
    return Eigen::Vector3d(v.x, v.y, v.z);
  };

  const double h = 1e-5;
  for (int trial = 0; trial < 4; ++trial) {
    const Pose pose = random_pose(s, rng);
    const PosedSkeleton posed = forward_kinematics(s, pose);
    const DualQuat all = blend(posed, [](int) { return true; });
    for (int column = 0; column < 6 + s.n_dofs(); ++column) {
      Eigen::VectorXd delta = Eigen::VectorXd::Zero(6 + s.n_dofs());
      delta[column] = h;
      const Eigen::Vector3d numeric = (skin(add_increment(pose, delta)) - skin(add_increment(pose, -delta))) / (2 * h);
      Eigen::Vector3d analytic;
      const Vec3 v = dual_quat_transform(all, rest);
      if (column < 3) {
        analytic = Eigen::Vector3d::Unit(column).cross(Eigen::Vector3d(v.x, v.y, v.z) - pose.root_translation_mm);
      } else if (column < 6) {
        analytic = Eigen::Vector3d::Unit(column - 3);
      } else {
        const int k = column - 6;
        const DualQuat moved = blend(posed, [&](int b) { return masks[b] >> k & 1; });
        const Eigen::Vector3d a = posed.dof_axis[k];
        const Eigen::Vector3d o = posed.dof_origin_mm[k];
        const DualQuat dq = dual_quat_turn_derivative(vec3(a.x(), a.y(), a.z()), vec3(o.x(), o.y(), o.z()), moved);
        const Vec3 d = dual_quat_transform_derivative(all, dq, rest);
        analytic = {d.x, d.y, d.z};
      }
      EXPECT_LT((numeric - analytic).norm(), test::kFiniteDifference * std::max(1.0, analytic.norm()))
          << "column " << column;
    }
  }
}

}  // namespace
}  // namespace livecap
