// What the second stage is for: the deforming surface is nearer to the truth than the skinned pose.
#include "capture/components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "capture/capture_run.h"
#include "capture/tracker_options.h"
#include "eval/capture_folder.h"
#include "eval/evaluate.h"
#include "livecap/camera.h"
#include "nn/models.h"
#include "support/builtin_actor.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(Components, TheSurfaceStageIsNearerInShapeAndSilhouette) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  const ScratchFolder scratch;
  SynthOptions synth;
  synth.n_frames = 50;
  synth.motions = {"walk"};
  write_sequence(synth, scratch / "sequence");
  const auto evaluated = [&](const std::string& name, bool surface, const std::vector<std::string>& without) {
    CaptureOptions options = test::capture_of(scratch / "sequence", scratch / name, model);
    options.surface = surface;
    options.without = without;
    run_capture(options);
    const EvalReport report = evaluate({scratch / name, scratch / "sequence/truth", "", "", {}});
    EXPECT_EQ(report.n_person, 40);
    EXPECT_EQ(report.n_lost, 0);
    RecordProperty("vertex_mm_" + name, format("%.2f", report.vertex_aligned_mm.mean));
    RecordProperty("loose_mm_" + name, format("%.2f", report.loose_aligned_mm.mean));
    RecordProperty("iou_" + name, format("%.4f", report.iou.mean));
    return report;
  };
  const EvalReport pose = evaluated("pose", false, {}), full = evaluated("full", true, {});
  const EvalReport unmatched = evaluated("unmatched", true, {"surface_match"});
  // Not where the person stands: that is the pose's, within half a millimetre here.
  EXPECT_LT(full.vertex_aligned_mm.mean, pose.vertex_aligned_mm.mean);
  EXPECT_GT(full.iou.mean, pose.iou.mean);
  EXPECT_LT(full.loose_aligned_mm.mean, unmatched.loose_aligned_mm.mean);
}

// An option that switches nothing off would make an ablation lie.
TEST(Components, EachOneMakesADifference) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  SynthOptions synth = test::small_sequence(9, 2);
  synth.motions = {"squat"};
  write_sequence(synth, scratch / "sequence");
  CaptureOptions options = test::capture_of(scratch / "sequence", scratch / "capture", model);
  const auto captured = [&] {
    run_capture(options);
    return read_file(scratch / "capture/vertices.pc2") + read_file(scratch / "capture/angles.csv");
  };
  const std::string everything = captured();
  EXPECT_TRUE(captured() == everything);
  for (const std::string& name : component_names()) {
    if (name == "anatomic") continue;     // a barrier: nothing while no joint reaches a limit
    if (name == "floor") continue;        // not known from the first frame on, see below
    if (name == "hidden_arms") continue;  // nothing while both are seen (tests/pose/held_arms_test.cpp)
    options.without = {name};
    EXPECT_FALSE(captured() == everything) << name;
  }
  options.without.clear();
  options.rigidity = 2;
  EXPECT_FALSE(captured() == everything);
}

TEST(Components, WithoutBalanceTheFloorIsWhereverFeetAre) {
  TrackerOptions options;
  switch_off("balance", options);
  Balance balance(options.floor.balance);
  const Actor& actor = test::builtin_actor("trousers");
  const auto positions = keypoint_positions(actor, forward_kinematics(actor.skeleton, rest_pose(actor.skeleton)));
  balance.learn(actor, positions, Eigen::Vector3d(0, 0, 1e5), Eigen::Vector3d::UnitY());
  EXPECT_EQ(balance.excess_mm(), 0);
  EXPECT_EQ(options.floor.balance.share, 0);
  EXPECT_EQ(options.starts.cost_of_imbalance, 0);
}

TEST(Components, WithoutHiddenArmsNoneIsHeldOrFoundAgain) {
  TrackerOptions options;
  EXPECT_GT(std::min(options.pose.hidden_share, options.starts.strayed_arm_share), 0);
  switch_off("hidden_arms", options);
  EXPECT_EQ(options.pose.hidden_share, 0);
  EXPECT_EQ(options.starts.strayed_arm_share, 0);
}

TEST(Components, VelocityGoesForWhatHangsAndForWhatDoesNot) {
  TrackerOptions options;
  EXPECT_GT(std::min(options.surface.w_velocity, options.surface.w_worn_velocity), 0);
  switch_off("velocity", options);
  EXPECT_EQ(options.surface.w_velocity, 0);
  EXPECT_EQ(options.surface.w_worn_velocity, 0);
}

TEST(Components, AFloorThatIsGivenCountsBeforeOneIsLearned) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  CaptureOptions options = test::capture_of_squat(scratch, 8, 2, true, model);
  const auto angles = [&](const std::vector<std::string>& without) {
    options.without = without;
    run_capture(options);
    return read_file(scratch / "capture/angles.csv");
  };
  const std::string given = angles({}), given_unused = angles({"floor"});
  EXPECT_TRUE(load_camera(scratch / "capture/camera.json").floor.has_value());
  Camera camera = load_camera(options.camera);
  ASSERT_TRUE(camera.floor.has_value());
  camera.floor.reset();
  save_camera(camera, options.camera);
  EXPECT_TRUE(angles({"floor"}) == given_unused);
  EXPECT_FALSE(angles({}) == given);
}

TEST(Components, AFloorThatFeetNeverRestOnIsToldOnce) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  // It takes 31 frames in which a foot rests elsewhere.
  CaptureOptions options = test::capture_of_squat(scratch, 60, 2, true, model);
  const auto n_told = [&] {
    testing::internal::CaptureStderr();
    run_capture(options);
    const std::string log = testing::internal::GetCapturedStderr(), what = "feet do not rest on the floor";
    int n = 0;
    for (size_t at = log.find(what); at != std::string::npos; at = log.find(what, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(n_told(), 0);
  Camera camera = load_camera(options.camera);
  camera.floor->distance_mm += 400;
  save_camera(camera, options.camera);
  EXPECT_EQ(n_told(), 1);
}

// With the true floor in the camera's file, and without: what was learned after 40 frames.
TEST(Components, TheFloorIsReported) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  CaptureOptions options = test::capture_of_squat(scratch, 40, 2, true, model);
  const auto reported = [&] {
    const std::optional<FloorPlane> floor = run_capture(options).floor;
    const std::optional<FloorPlane> written = open_capture(options.out, "", "", {}).floor;
    EXPECT_EQ(floor.has_value(), written.has_value());
    EXPECT_TRUE(floor && written && floor->normal == written->normal && floor->distance_mm == written->distance_mm);
    return floor.value();
  };
  Camera camera = load_camera(options.camera);
  const FloorPlane truth = camera.floor.value(), given = reported();
  EXPECT_NEAR(given.distance_mm, truth.distance_mm, test::kDoubleExact);
  EXPECT_NEAR(given.normal[2], truth.normal[2], test::kDoubleExact);
  camera.floor.reset();
  save_camera(camera, options.camera);
  const FloorPlane learned = reported();
  EXPECT_NE(learned.distance_mm, truth.distance_mm);
  double cosine = 0;
  for (int i = 0; i < 3; ++i) cosine += learned.normal[i] * truth.normal[i];
  EXPECT_LT(std::acos(cosine), test::kReportedFloorRad);
  EXPECT_NEAR(learned.distance_mm, truth.distance_mm, test::kReportedFloorMm);
  camera.floor = truth;
  save_camera(camera, options.camera);
  options.floor = scratch / "capture/report.json";
  options.out = scratch / "again";
  const FloorPlane again = reported();
  EXPECT_EQ(load_camera(scratch / "again/camera.json").floor.value().distance_mm, learned.distance_mm);
  EXPECT_NEAR(again.distance_mm, learned.distance_mm, test::kDoubleExact)
      << "it stays, whatever the camera's file says";
  EXPECT_NEAR(again.normal[2], learned.normal[2], test::kDoubleExact);
  EXPECT_EQ(open_capture(options.out, "", "", {}).camera.floor.value().distance_mm, again.distance_mm);
}

TEST(Components, TheFloorMakesADifferenceOnceItIsKnown) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  CaptureOptions options = test::capture_of_squat(scratch, 30, 2, false, model);
  const auto angles = [&] {
    run_capture(options);
    return read_file(scratch / "capture/angles.csv");
  };
  const std::string with = angles();
  options.without = {"floor"};
  const std::string without = angles();
  const size_t unknown_until = with.find("\n4,");
  ASSERT_NE(unknown_until, std::string::npos);
  EXPECT_EQ(with.substr(0, unknown_until), without.substr(0, unknown_until));
  EXPECT_NE(with, without);
}

}  // namespace
}  // namespace livecap
