#include "actor/livecap_skeleton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

#include "support/tolerances.h"

namespace livecap {
namespace {

RigPositions random_rig(std::mt19937& rng) {
  std::normal_distribution<double> jitter(0, 25);
  RigPositions p;
  p.fill(Eigen::Vector3d::Zero());
  p[kRigRoot] = {0, 980, 0};
  p[kRigChest] = {0, 1280, -20};
  p[kRigNeck] = {0, 1480, 0};
  for (int side : {1, -1}) {
    const bool left = side > 0;
    p[left ? kRigLeftClavicle : kRigRightClavicle] = {50.0 * side, 1440, 0};
    p[left ? kRigLeftShoulder : kRigRightShoulder] = {170.0 * side, 1420, 0};
    p[left ? kRigLeftElbow : kRigRightElbow] = {410.0 * side, 1300, 0};
    p[left ? kRigLeftWrist : kRigRightWrist] = {620.0 * side, 1180, 30};
    p[left ? kRigLeftHip : kRigRightHip] = {95.0 * side, 920, 0};
    p[left ? kRigLeftKnee : kRigRightKnee] = {110.0 * side, 510, 20};
    p[left ? kRigLeftAnkle : kRigRightAnkle] = {120.0 * side, 90, 0};
  }
  for (Eigen::Vector3d& x : p) x += Eigen::Vector3d(jitter(rng), jitter(rng), jitter(rng));
  return p;
}

TEST(LivecapSkeleton, ChestCollarbonesTwistedArmsAndFeetAreDrawnToRest) {
  std::mt19937 rng(2);
  std::vector<std::string> notes;
  for (const Dof& dof : build_livecap_skeleton(random_rig(rng), true, {}, notes).dofs) {
    const bool collarbone = dof.name.find("clavicle") != std::string::npos;
    const bool foot = dof.name.find("ankle") != std::string::npos && !dof.name.ends_with("_x");
    const bool twist = dof.name == "left_shoulder_x" || dof.name == "right_shoulder_x";
    EXPECT_EQ(dof.rest_share > 0, collarbone || foot || twist || dof.name.starts_with("chest")) << dof.name;
    if (twist) EXPECT_LT(dof.rest_share, 0.1) << "a bent arm is not untwisted";
    EXPECT_EQ(dof.rest_share > 1, foot) << dof.name;
    // Raised arms lift them; nothing says where they turn forward.
    if (collarbone) EXPECT_EQ(dof.rest_share < 1, dof.name.ends_with("_z")) << dof.name;
  }
}

TEST(LivecapSkeleton, RestReproducesAnyJointPositions) {
  std::mt19937 rng(1);
  for (int trial = 0; trial < 50; ++trial) {
    const RigPositions p = random_rig(rng);
    std::vector<std::string> notes;
    const Skeleton s = build_livecap_skeleton(p, true, {}, notes);
    ASSERT_EQ(s.n_bones(), 15);
    ASSERT_EQ(s.n_dofs(), 32);
    const PosedSkeleton rest = forward_kinematics(s, rest_pose(s));
    for (int b = 0; b < kRigBoneCount; ++b)
      EXPECT_LT((rest.camera_from_bone[b].translation() - p[b]).norm(), test::kDoubleExact);
    for (const Dof& dof : s.dofs) EXPECT_TRUE(dof.min_rad <= dof.rest_rad && dof.rest_rad <= dof.max_rad) << dof.name;
  }
}

TEST(LivecapSkeleton, AStiffTrunkHasNoAnglesOfTheChest) {
  std::mt19937 rng(3);
  std::vector<std::string> notes;
  const RigPositions p = random_rig(rng);
  const Skeleton stiff = build_livecap_skeleton(p, false, {}, notes),
                 bends = build_livecap_skeleton(p, true, {}, notes);
  ASSERT_EQ(stiff.n_bones(), 15);
  ASSERT_EQ(stiff.n_dofs(), 29);
  for (int k = 0; k < 29; ++k) EXPECT_EQ(stiff.dofs[k].name, bends.dofs[k + 3].name);
}

// Arms, collarbones and head turn with the chest, legs do not; leaning forward is positive.
TEST(LivecapSkeleton, TheChestCarriesArmsAndHead) {
  std::mt19937 rng(4);
  std::vector<std::string> notes;
  const Skeleton s = build_livecap_skeleton(random_rig(rng), true, {}, notes);
  const PosedSkeleton rest = forward_kinematics(s, rest_pose(s));
  Pose pose = rest_pose(s);
  pose.angles_rad[0] += 0.4;
  const PosedSkeleton bent = forward_kinematics(s, pose);
  for (int b = 0; b < kRigBoneCount; ++b) {
    const double turned = (bent.camera_from_bone[b].linear() - rest.camera_from_bone[b].linear()).norm();
    const bool carried = b >= kRigChest && b < kRigLeftHip;
    EXPECT_NEAR(turned, carried ? std::sqrt(2.0) * 2 * std::sin(0.2) : 0, test::kDoubleExact) << kRigJointNames[b];
  }
  EXPECT_GT(bent.camera_from_bone[kRigNeck].translation().z(), rest.camera_from_bone[kRigNeck].translation().z());
}

// docs/formats.md, spot checks by name, order and mirrored limits.
TEST(LivecapSkeleton, FollowsTheTable) {
  std::mt19937 rng(1);
  std::vector<std::string> notes;
  const Skeleton s = build_livecap_skeleton(random_rig(rng), true, {}, notes);
  const char* const names[] = {"chest_x",          "chest_y",          "chest_z",          "neck_x",
                               "neck_y",           "neck_z",           "left_clavicle_y",  "left_clavicle_z",
                               "right_clavicle_y", "right_clavicle_z", "left_shoulder_z",  "left_shoulder_y",
                               "left_shoulder_x",  "left_elbow_y",     "right_shoulder_z", "right_shoulder_y",
                               "right_shoulder_x", "right_elbow_y",    "left_hip_x",       "left_hip_y",
                               "left_hip_z",       "right_hip_x",      "right_hip_y",      "right_hip_z",
                               "left_knee_x",      "right_knee_x",     "left_ankle_x",     "left_ankle_y",
                               "left_ankle_z",     "right_ankle_x",    "right_ankle_y",    "right_ankle_z"};
  constexpr double kDeg = std::numbers::pi / 180;
  for (int k = 0; k < 32; ++k) EXPECT_EQ(s.dofs[k].name, names[k]);
  EXPECT_NEAR(s.dofs[13].min_rad, -150 * kDeg, test::kDoubleExact);
  EXPECT_NEAR(s.dofs[17].max_rad, 150 * kDeg, test::kDoubleExact);
  EXPECT_NEAR(s.dofs[20].max_rad, 70 * kDeg, test::kDoubleExact);
  EXPECT_NEAR(s.dofs[23].min_rad, -70 * kDeg, test::kDoubleExact);
  EXPECT_NEAR(s.dofs[28].min_rad, -35 * kDeg, test::kDoubleExact);
  EXPECT_NEAR(s.dofs[31].max_rad, 35 * kDeg, test::kDoubleExact);
  // A positive knee angle takes the foot back, an elbow angle within limits takes the hand to the front.
  Pose pose = rest_pose(s);
  pose.angles_rad[24] += 0.5;
  EXPECT_LT(forward_kinematics(s, pose).camera_from_bone[kRigLeftAnkle].translation().z(),
            forward_kinematics(s, rest_pose(s)).camera_from_bone[kRigLeftAnkle].translation().z());
}

// Feet turn their soles inwards further than outwards: the outer edge of either goes down.
TEST(LivecapSkeleton, FeetTiltSoThatSolesFaceEachOther) {
  std::mt19937 rng(5);
  std::vector<std::string> notes;
  const Skeleton s = build_livecap_skeleton(random_rig(rng), true, {}, notes);
  const PosedSkeleton rest = forward_kinematics(s, rest_pose(s));
  for (const auto& [name, bone, outwards] :
       {std::tuple{"left_ankle_z", kRigLeftAnkle, 1.0}, {"right_ankle_z", kRigRightAnkle, -1.0}}) {
    const auto dof = std::find_if(s.dofs.begin(), s.dofs.end(), [&](const Dof& d) { return d.name == name; });
    ASSERT_NE(dof, s.dofs.end()) << name;
    Pose pose = rest_pose(s);
    double& angle = pose.angles_rad[dof - s.dofs.begin()];
    angle = std::abs(dof->min_rad) > dof->max_rad ? dof->min_rad : dof->max_rad;
    const Eigen::Isometry3d moved = forward_kinematics(s, pose).camera_from_rest[bone];
    const Eigen::Vector3d ankle = rest.camera_from_bone[bone].translation();
    EXPECT_LT((moved * (ankle + Eigen::Vector3d(40 * outwards, -80, 0))).y() -
                  (moved * (ankle + Eigen::Vector3d(-40 * outwards, -80, 0))).y(),
              -30)
        << name;
  }
}

}  // namespace
}  // namespace livecap
