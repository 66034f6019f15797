// How rounds of stage I follow each other, on the host and on devices, and what counts in them.
#include "capture/pose_rounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "capture/pose_stage_scene.h"
#include "cloth/hanging_cloth.h"
#include "support/gpu_bodies.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::Seen, test::turned, test::under;

// Whether the camera's file tells where it is. Between a floor and shoes a match that is turned over takes legs that
// E_3D hardly holds ten times as far, and what is learned of them carries it on to the next frame: with the legs held
// E_3D counts on them as elsewhere, and nothing is learned.
enum Ground { kUnknown, kKnownLegsHeld, kKnown };

// Poses and energies of some frames, each tracked from the truth of the one before. n_ahead: of the first frames whose
// rounds are launched at once. silhouette: factor of its weight.
std::vector<PoseResult> track(ocl::DeviceContext& device, int n_frames, int n_ahead = 0, Ground floor = kUnknown,
                              double silhouette = 1) {
  Seen seen(device);
  if (floor != kUnknown) seen.camera.floor = under(seen.actor, turned(seen.actor, 0));
  TrackerOptions options;
  options.shading.light.harmonics.least_frames = options.actor_light.least_frames = 0.5;
  options.pose.weights.silhouette *= silhouette;
  if (floor == kKnownLegsHeld) {
    options.rounds.on_feet_legs_3d = 1;
    options.leg_bias.prior = 1e9;
  }
  PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
  std::vector<PoseResult> results;
  for (int frame = 1; frame <= n_frames; ++frame) {
    const Pose before = turned(seen.actor, frame - 1), truth = turned(seen.actor, frame);
    const Silhouette silhouette = seen.take_picture(stage, truth);
    const Detections detections = test::exact_detections(seen.actor, seen.camera, truth, 0.97);
    const PoseStageInput input{detections, silhouette, seen.frame};
    stage.set_picture(input);
    EXPECT_EQ(stage.looks_ahead(input), frame <= n_ahead);
    results.push_back(stage.solve_tracked(input, before, before));
    EXPECT_EQ(results.back().status, SolveStatus::kOk);
    stage.learn(input, &before, results.back().pose);
  }
  return results;
}

// Of a GPU that launches a round's kernels one by one.
ocl::DeviceInfo without_sight(ocl::DeviceInfo info) {
  info.has_long_atomics = false;
  return info;
}

// The rounds of a frame come to the same bits whether the device chooses or the host of what it reads.
TEST(PoseRounds, WhatTheDeviceChoosesIsWhatIsRead) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    ocl::DeviceInfo info = without_sight(device.info());
    ocl::DeviceContext chooses(info);
    info.max_work_group_size = LC_POSE_CHOICE_GROUP / 2;
    ocl::DeviceContext reads(info);
    const Actor& actor = test::builtin_actor("skirt");
    ASSERT_TRUE(PoseSolver(chooses, actor, test::portrait_camera(), {}).chooses());
    ASSERT_FALSE(PoseSolver(reads, actor, test::portrait_camera(), {}).chooses());
    const std::vector<PoseResult> got = track(chooses, 2), expected = track(reads, 2);
    EXPECT_GT(expected[0].energy.match, 0);
    EXPECT_GT(expected[0].energy.silhouette, 0);
    EXPECT_GT(expected[1].energy.shading, 0) << "the light is known by then";
    for (int frame = 0; frame < 2; ++frame) {
      EXPECT_EQ(got[frame].pose.angles_rad, expected[frame].pose.angles_rad);
      EXPECT_EQ(got[frame].pose.root_translation_mm, expected[frame].pose.root_translation_mm);
      EXPECT_EQ(got[frame].step_energy, expected[frame].step_energy);
      EXPECT_EQ(got[frame].energy.silhouette, expected[frame].energy.silhouette);
      EXPECT_NEAR(got[frame].missed_weight, expected[frame].missed_weight, 1e-4 * expected[frame].missed_weight);
      EXPECT_NEAR(got[frame].seen_weight, expected[frame].seen_weight, 1e-4 * expected[frame].seen_weight);
    }
  });
}

bool is_near(double a, double b, double share) {
  return std::abs(a - b) <= share * std::abs(b);
}

// Empty where they are, else what is not.
std::string rounds_that_differ(const PoseResult& ahead, const PoseResult& waits) {
  std::ostringstream differs;
  const double angles_rad = (ahead.pose.angles_rad - waits.pose.angles_rad).lpNorm<Eigen::Infinity>();
  const double root_mm = (ahead.pose.root_translation_mm - waits.pose.root_translation_mm).norm();
  if (!(angles_rad < test::kRoundsRad)) differs << " angles by " << angles_rad << " rad";
  if (!(root_mm < test::kRoundsMm)) differs << " root by " << root_mm << " mm";
  if (ahead.step_energy.size() != waits.step_energy.size()) differs << " steps";
  if (!is_near(ahead.energy.silhouette, waits.energy.silhouette, 1e-3)) differs << " E_silhouette";
  if (!is_near(ahead.missed_weight, waits.missed_weight, 1e-4)) differs << " missed weight";
  if (!is_near(ahead.seen_weight, waits.seen_weight, 1e-4)) differs << " seen weight";
  if (!is_near(ahead.energy.keypoint_3d, waits.energy.keypoint_3d, 1e-3)) differs << " E_3D";
  if (!is_near(ahead.energy.total(), waits.energy.total(), 1e-3)) differs << " energy";
  if (!(std::abs(ahead.moved_px - waits.moved_px) <= 1e-3)) differs << " way";
  if (!is_near(ahead.energy.floor, waits.energy.floor, 1e-3)) differs << " E_floor";
  return differs.str();
}

// In some frames a vertex stands on the edge of another pixel, or a match of how far it may be: the last bits of a pose
// turn it over, which moves that by 1e-3 rad. Which frames these are depends on the silhouette's weight and on the
// device, so each must agree with one of some weights, and none may be further off than a match that is turned over
// brings it.
void expect_rounds_ahead_are_the_hosts(Ground floor, double most_turned_rad, int n_weights) {
  test::on_every_gpu_body([&](ocl::DeviceContext& device) {
    ocl::DeviceContext one_by_one(without_sight(device.info()));
    std::string differ;
    std::array<bool, 2> agrees{};
    const auto all_agree = [&] { return std::ranges::all_of(agrees, std::identity{}); };
    for (int draw = 1; draw <= n_weights && !all_agree(); ++draw) {
      const double silhouette = 1 + 0.001 * draw;
      const std::vector<PoseResult> got = track(device, 2, 2, floor, silhouette),
                                    expected = track(one_by_one, 2, 0, floor, silhouette);
      EXPECT_GT(expected[1].energy.shading, 0) << "the light is known by then";
      for (int frame = 0; frame < 2; ++frame) {
        EXPECT_EQ(expected[frame].energy.floor > 0, floor != kUnknown);
        const std::string what = rounds_that_differ(got[frame], expected[frame]);
        agrees[frame] = agrees[frame] || what.empty();
        EXPECT_LT((got[frame].pose.angles_rad - expected[frame].pose.angles_rad).lpNorm<Eigen::Infinity>(),
                  most_turned_rad)
            << what;
        differ += " | " + what;
      }
      differ += '\n';
    }
    EXPECT_TRUE(all_agree()) << differ;
  });
}

// All rounds launched at once, with what the device decides in between, against the host that waits for each.
TEST(PoseRounds, RoundsAheadAreTheHosts) {
  expect_rounds_ahead_are_the_hosts(kUnknown, test::kTurnedMatchRad, 12);
}

TEST(PoseRounds, RoundsAheadOnAKnownFloorAreTheHosts) {
  expect_rounds_ahead_are_the_hosts(kKnownLegsHeld, test::kTurnedMatchRad, 12);
}

// As it is shipped, but for shoes (see track()). More weights are tried, since fewer frames agree.
TEST(PoseRounds, RoundsAheadOnAKnownFloorWithFreeLegsAreTheHosts) {
  expect_rounds_ahead_are_the_hosts(kKnown, test::kTurnedLegsRad, 12);
}

// PoCL has no fence between work-groups: the frame whose look is given up is solved as if nobody had looked, and those
// after it are not looked at ahead.
TEST(PoseRounds, ALookThatIsGivenUpChangesNothing) {
  test::on_every_device([](ocl::DeviceContext& device) {
    if (!device.is_cpu()) return;
    ocl::DeviceInfo info = device.info();
    info.is_cpu = false;
    info.compute_units = 3;
    ocl::DeviceContext gives_up(info), never_looks(without_sight(info));
    const std::vector<PoseResult> got = track(gives_up, 2, 1), expected = track(never_looks, 2);
    for (int frame = 0; frame < 2; ++frame) {
      EXPECT_GT(expected[frame].energy.match, 0);
      EXPECT_EQ(got[frame].pose.angles_rad, expected[frame].pose.angles_rad);
      EXPECT_EQ(got[frame].pose.root_translation_mm, expected[frame].pose.root_translation_mm);
      EXPECT_EQ(got[frame].step_energy, expected[frame].step_energy);
      EXPECT_EQ(got[frame].energy.total(), expected[frame].energy.total());
    }
  });
}

// How far the upper arm goes that the network does not see and puts where the other one is, while the picture has it
// raised by 0.15, rad.
double hidden_arm_rad(ocl::DeviceContext& device, bool ahead, double hidden_share) {
  Seen seen(device);
  TrackerOptions options;
  options.pose.hidden_share = hidden_share;
  PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
  const auto& dofs = seen.actor.skeleton.dofs;
  const auto raises = std::ranges::find(dofs, "left_shoulder_z", &Dof::name) - dofs.begin();
  const Pose before = turned(seen.actor, 0);
  Pose truth = turned(seen.actor, 1);
  truth.angles_rad[raises] += 0.15;
  const Silhouette silhouette = seen.take_picture(stage, truth);
  Detections detections = test::exact_detections(seen.actor, seen.camera, truth, 0.97);
  for (int left : {kLeftElbow, kLeftWrist}) {
    detections.keypoints[left] = detections.keypoints[left + 1];
    detections.keypoints[left].confidence = 0.1f;
  }
  const PoseStageInput input{detections, silhouette, seen.frame};
  const FloorFinder floor(seen.actor, {}, {});
  PoseRounds rounds(device, seen.actor, seen.camera, options, floor, seen.rasterizer, seen.visibility);
  rounds.set_picture(input);
  EXPECT_EQ(rounds.looks_ahead(input), ahead);
  const PoseResult result = rounds.solve(input, detections, before, &before, PoseRounds::Rounds::kAll).pose;
  EXPECT_EQ(result.status, SolveStatus::kOk);
  return result.pose.angles_rad[raises] - before.angles_rad[raises];
}

TEST(PoseRounds, RoundsAheadHoldAHiddenArmAsTheHosts) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    ocl::DeviceContext one_by_one(without_sight(device.info()));
    const double share = PoseOptions().hidden_share, waits = hidden_arm_rad(one_by_one, false, share);
    EXPECT_NEAR(hidden_arm_rad(device, true, share), waits, test::kTurnedMatchRad);
    EXPECT_GT(hidden_arm_rad(device, true, 0), waits + 2 * test::kTurnedMatchRad) << "that is not held";
  });
}

// Of vertices that are not matched because they hang.
int n_hanging_contour(ocl::DeviceContext& device, int refining_rounds) {
  Seen seen(device);
  TrackerOptions options;
  options.rounds.refining_rounds = refining_rounds;
  PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
  seen.track(stage, turned(seen.actor, 0), turned(seen.actor, 1));
  const std::vector<float> legs = leg_weights(seen.actor);
  const std::vector<int32_t> contour = seen.visibility.read_contour();
  return std::count_if(contour.begin(), contour.end(), [&](int32_t i) {
    return seen.actor.rigidity[i] < options.shares.min_matched_rigidity &&
           legs[i] >= options.shares.max_matched_leg_weight;
  });
}

TEST(PoseRounds, HangingClothIsNoContourInTheLastRounds) {
  test::on_every_device([](ocl::DeviceContext& device) {
    EXPECT_EQ(n_hanging_contour(device, TrackerOptions{}.rounds.refining_rounds), 0);
    EXPECT_GT(n_hanging_contour(device, 0), 0);
  });
}

// E_match of one round on a skirt that hangs beside where skinning has it.
double match_energy(ocl::DeviceContext& device, int refining_rounds, float hanging_share, float foot_share = 1,
                    bool rough = false) {
  Seen seen(device);
  Actor actor = seen.actor;
  actor.rough_shape = rough;
  TrackerOptions options;
  options.shares.foot_share = foot_share;
  options.rounds.match_levels = {0};
  options.rounds.refining_rounds = refining_rounds;
  options.shares.refined_hanging_share = hanging_share;
  PoseStage stage(device, actor, seen.camera, options, seen.rasterizer, seen.visibility);
  return seen.track(stage, turned(seen.actor, 0), turned(seen.actor, 2)).energy.match;
}

TEST(PoseRounds, HangingClothIsMatchedWithLessWeightInTheLastRounds) {
  test::on_every_device([](ocl::DeviceContext& device) {
    EXPECT_EQ(match_energy(device, 0, 0.3f), match_energy(device, 0, 1)) << "other rounds";
    EXPECT_LT(match_energy(device, 1, 0.3f), match_energy(device, 1, 1));
  });
}

TEST(PoseRounds, FeetAreMatchedWithMoreWeightInTheLastRounds) {
  test::on_every_device([](ocl::DeviceContext& device) {
    EXPECT_EQ(match_energy(device, 0, 0.3f, 40), match_energy(device, 0, 0.3f, 1)) << "other rounds";
    EXPECT_GT(match_energy(device, 1, 0.3f, 40), match_energy(device, 1, 0.3f, 1));
    const float rough = PoseSharesOptions().rough_foot_share;
    EXPECT_EQ(match_energy(device, 1, 0.3f, 40, true), match_energy(device, 1, 0.3f, rough)) << "of a rough shape";
    EXPECT_LT(rough, PoseSharesOptions().foot_share);
  });
}

}  // namespace
}  // namespace livecap
