// What E_rest draws joint angles to, and that an arm nobody sees goes along with the trunk.
#include "pose/held_arms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pose/pose_solver.h"
#include "support/pose_scene.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

bool hangs_on(const Actor& actor, int k, const char* bone) {
  return hangs_on(actor.skeleton, actor.skeleton.dofs[k].bone, actor.skeleton.bone_index(bone));
}

void see_left_arm(Detections& detections, float elbow, float wrist) {
  detections.keypoints[kLeftElbow].confidence = elbow;
  detections.keypoints[kLeftWrist].confidence = wrist;
}

TEST(HeldArms, OnlyWhatIsHiddenKeepsItsAngles) {
  const Actor actor = test::make_test_actor();
  const PoseOptions options;
  Pose previous = test::standing_pose(actor, 0);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) previous.angles_rad[k] = 0.01 * (k + 1);
  Detections detections = test::exact_detections(actor, test::portrait_camera(), previous);
  // held_from: the bone from which on the previous pose's angles are; nullptr: nowhere
  const auto expect_held = [&](const std::vector<RestAngle>& rest, const char* held_from) {
    ASSERT_EQ(int(rest.size()), actor.skeleton.n_dofs());
    int n_held = 0;
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
      const Dof& dof = actor.skeleton.dofs[k];
      const bool held = held_from && hangs_on(actor, k, held_from);
      n_held += held;
      EXPECT_EQ(rest[k].rad, held ? previous.angles_rad[k] : dof.rest_rad) << dof.name;
      EXPECT_EQ(rest[k].weight, options.weights.rest * (held ? options.hidden_share : dof.rest_share)) << dof.name;
    }
    EXPECT_EQ(n_held > 0, held_from != nullptr);
  };
  expect_held(rest_angles(actor, detections, &previous, options), nullptr);
  see_left_arm(detections, 0.1f, 0.2f);
  expect_held(rest_angles(actor, detections, &previous, options), "left_shoulder");
  expect_held(rest_angles(actor, detections, nullptr, options), nullptr);
  see_left_arm(detections, NAN, NAN);
  expect_held(rest_angles(actor, detections, &previous, options), "left_shoulder");
  see_left_arm(detections, 0.1f, 0.9f);
  expect_held(rest_angles(actor, detections, &previous, options), nullptr);
  see_left_arm(detections, 0.9f, 0.1f);
  expect_held(rest_angles(actor, detections, &previous, options), "left_elbow");
}

// The trunk turns by 0.3 rad; the network, which does not see the left arm, puts it where the right one is.
TEST(HeldArms, AHiddenArmGoesAlongWithTheTrunk) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor actor = test::make_test_actor();
    const Camera camera = test::portrait_camera();
    const Pose before = test::standing_pose(actor, 0), truth = test::standing_pose(actor, 0.3);
    Detections detections = test::exact_detections(actor, camera, truth);
    for (const auto& [left, right] : {std::pair{kLeftElbow, kRightElbow}, {kLeftWrist, kRightWrist}})
      detections.keypoints[left] = detections.keypoints[right];
    see_left_arm(detections, 0.1f, 0.1f);
    const auto most_turned_rad = [&](double hidden_share, bool holds_arms = true) {
      PoseOptions options;
      options.hidden_share = hidden_share;
      PoseSolver solver(device, actor, camera, options);
      const PoseResult result =
          solver.solve({.detections = detections, .initial = before, .previous = &before, .holds_arms = holds_arms});
      EXPECT_EQ(result.status, SolveStatus::kOk);
      double most = 0;
      for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
        if (hangs_on(actor, k, "left_shoulder"))
          most = std::max(most, std::abs(result.pose.angles_rad[k] - before.angles_rad[k]));
      return most;
    };
    EXPECT_LT(most_turned_rad(PoseOptions().hidden_share), test::kHiddenArmRad);
    EXPECT_GT(most_turned_rad(0), 5 * test::kHiddenArmRad);
    EXPECT_EQ(most_turned_rad(PoseOptions().hidden_share, false), most_turned_rad(0));
  });
}

// So that poses that follow none compete with one that does.
TEST(HeldArms, WhatHoldsAnArmIsToldFromTheRestOfERest) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Actor actor = test::make_test_actor();
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k) actor.skeleton.dofs[k].rest_share = 0.01 * (k + 1);
    const Camera camera = test::portrait_camera();
    const PoseOptions options;
    const Pose before = test::standing_pose(actor, 0), truth = test::standing_pose(actor, 0.3);
    Detections detections = test::exact_detections(actor, camera, truth);
    PoseSolver solver(device, actor, camera, options);
    EXPECT_EQ(held_energy(actor, detections, before, options, truth), 0) << "nothing is hidden";
    detections.keypoints[kLeftWrist] = detections.keypoints[kRightWrist];
    see_left_arm(detections, 0.1f, 0.1f);
    const PoseResult result = solver.solve({.detections = detections, .initial = before, .previous = &before});
    ASSERT_EQ(result.status, SolveStatus::kOk);
    double not_held = 0, at_rest = 0;
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
      const double off_rad = result.pose.angles_rad[k] - actor.skeleton.dofs[k].rest_rad;
      const double energy = options.weights.rest * actor.skeleton.dofs[k].rest_share * off_rad * off_rad;
      at_rest += energy;
      if (!hangs_on(actor, k, "left_shoulder")) not_held += energy;
    }
    EXPECT_GT(result.energy.rest, 1.1 * not_held);
    EXPECT_NEAR(result.energy.rest - held_energy(actor, detections, before, options, result.pose), at_rest,
                test::kPoseJacobian * result.energy.rest);
  });
}

}  // namespace
}  // namespace livecap
