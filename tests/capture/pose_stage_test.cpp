// What stage I draws.
#include "capture/pose_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "capture/expected_detections.h"
#include "capture/pose_stage_scene.h"
#include "cloth/hanging_cloth.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::Seen, test::turned, test::under;

// A skirt over a raised thigh hangs from the pelvis in stage I as in stage II.
TEST(PoseStage, HangingClothIsNotFastenedToTheLegs) {
  const Actor& actor = test::builtin_actor("skirt");
  const Camera camera = test::portrait_camera();
  Pose pose = test::standing_pose(actor, 0.5);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "left_hip_x") pose.angles_rad[k] = -0.8;
  test::on_every_device([&](ocl::DeviceContext& device) {
    DepthRasterizer rasterizer(device, actor.mesh, camera.width, camera.height);
    SurfaceVisibility visibility(device, actor.mesh, {});
    const TrackerOptions options;
    PoseStage stage(device, actor, camera, options, rasterizer, visibility);
    stage.render(pose);
    const std::vector<float> drawn = rasterizer.depth().read_all();

    const auto drawn_with = [&](const SkinWeights& skin) {
      Skinner skinner(device, actor, skin, actor.skeleton.n_bones());
      ocl::Buffer<float> zero(device, size_t(3) * actor.n_vertices()), skinned(device, size_t(3) * actor.n_vertices());
      zero.fill(0);
      skinner.set_pose(bone_dual_quats(forward_kinematics(actor.skeleton, pose)));
      skinner.skin(zero, skinned);
      rasterizer.render(skinned, camera);
      return rasterizer.depth().read_all();
    };
    EXPECT_EQ(drawn, drawn_with(hanging_weights(actor, options.hanging)));
    EXPECT_NE(drawn, drawn_with(actor.skin));
  });
}

// How far too near to the camera the neck of somebody who is seen for the first time is found, from the pelvis, mm,
// where the network sees them lean by lean_rad.
double found_lean_mm(ocl::DeviceContext& device, double lean_rad, const std::vector<double>& leans_rad,
                     const std::vector<int>& match_levels = {}) {
  Seen seen(device);
  TrackerOptions options;
  options.starts.leans_rad = leans_rad;
  if (!match_levels.empty()) options.rounds.match_levels = match_levels;
  PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
  const Pose truth = turned(seen.actor, 0);
  Detections detections = test::exact_detections(seen.actor, seen.camera, truth);
  const Eigen::Matrix3f lean = Eigen::AngleAxisf(float(lean_rad), Eigen::Vector3f::UnitX()).toRotationMatrix();
  for (KeypointDetection& point : detections.keypoints) {
    const Eigen::Vector3f leant = lean * Eigen::Vector3f(point.x_mm, point.y_mm, point.z_mm);
    point.x_mm = leant.x(), point.y_mm = leant.y(), point.z_mm = leant.z();
  }
  const PoseResult found = seen.find(stage, detections, truth);
  const auto ahead = [&](const Pose& pose) {
    const auto points = keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, pose));
    return points[kPelvis].z() - points[kNeck].z();
  };
  return ahead(found.pose) - ahead(truth);
}

TEST(PoseStage, ANetworkThatSeesALeanLeansNobody) {
  test::on_every_device([](ocl::DeviceContext& device) {
    for (double lean : {-0.45, 0.45})
      EXPECT_LT(std::abs(found_lean_mm(device, lean, TrackerOptions{}.starts.leans_rad)), test::kFoundLeanMm) << lean;
    // Matched at full resolution alone, legs alone do not straighten the body.
    const double alone = std::abs(found_lean_mm(device, 0.6, {}, {0}));
    EXPECT_LT(std::abs(found_lean_mm(device, 0.6, TrackerOptions{}.starts.leans_rad, {0})), alone / 2);
  });
}

// Energies of the steps of a frame whose light is known, of an actor whose skirt is one or cloth that does not hang.
std::vector<double> energies_with(ocl::DeviceContext& device, bool guessed, bool skirt, const TrackerOptions& given) {
  Seen seen(device);
  Actor actor = seen.actor;
  actor.guessed_weights = guessed;
  for (float& rigidity : actor.rigidity) rigidity = skirt ? rigidity : std::max(rigidity, 2.0f);
  TrackerOptions options = given;
  options.shading.light.harmonics.least_frames = 0.5;
  PoseStage stage(device, actor, seen.camera, options, seen.rasterizer, seen.visibility);
  PoseResult result;
  for (int frame = 1; frame <= 2; ++frame) {
    const Pose before = turned(actor, frame - 1), truth = turned(actor, frame);
    const Silhouette silhouette = seen.take_picture(stage, truth);
    const Detections detections = test::exact_detections(actor, seen.camera, truth);
    const PoseStageInput input{detections, silhouette, seen.frame};
    stage.set_picture(input);
    result = stage.solve_tracked(input, before, before);
    stage.learn(input, &before, result.pose);
  }
  EXPECT_GT(result.energy.silhouette, 0);
  EXPECT_GT(result.energy.shading, 0);
  return result.step_energy;
}

TEST(PoseStage, KeypointsOutlineAndShadingCountMoreWhereWeightsAreGuessed) {
  test::on_every_device([](ocl::DeviceContext& device) {
    TrackerOptions guess, weighted, shaded;
    weighted.match.blur = shaded.match.blur = guess.guessed.blur = 0.1f;
    guess.guessed.keypoint_2d = 5;
    guess.guessed.silhouette = 3;
    guess.guessed.shading = 1.5;
    weighted.pose.weights.keypoint_2d *= 5;
    weighted.pose.weights.silhouette *= 3;
    weighted.pose.weights.shading *= 1.5;
    const std::vector<double> as_ever = energies_with(device, false, false, {});
    EXPECT_EQ(energies_with(device, false, false, guess), as_ever) << "painted weights";
    EXPECT_EQ(energies_with(device, true, false, guess), energies_with(device, false, false, weighted));
    EXPECT_NE(energies_with(device, true, false, {}), as_ever);
    shaded.pose.weights.shading *= 1.5;
    const std::vector<double> in_a_skirt = energies_with(device, false, true, shaded);
    EXPECT_NE(energies_with(device, true, true, guess), in_a_skirt);
    guess.hanging.guessed_power = 1;
    EXPECT_EQ(energies_with(device, true, true, guess), in_a_skirt);
  });
}

// Furthest that a foot is from where it is, mm, in frames whose detections have the legs exchanged from the knees down.
double exchanged_feet_mm(ocl::DeviceContext& device, bool with_picture, int max_exchanged_frames) {
  Seen seen(device);
  TrackerOptions options;
  options.starts.max_exchanged_frames = max_exchanged_frames;
  PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
  double furthest = 0;
  for (int frame = 1; frame <= max_exchanged_frames + 1; ++frame) {
    const Pose before = turned(seen.actor, frame - 1), truth = turned(seen.actor, frame);
    Silhouette silhouette = seen.take_picture(stage, truth);
    if (!with_picture) silhouette = {};
    Detections detections = test::exact_detections(seen.actor, seen.camera, truth);
    for (int left : {kLeftKnee, kLeftAnkle, kLeftToe})
      std::swap(detections.keypoints[left], detections.keypoints[left + 1]);
    const PoseStageInput input{detections, silhouette, seen.frame};
    stage.set_picture(input);
    const PoseResult result = stage.solve_tracked(input, before, before);
    EXPECT_EQ(result.status, SolveStatus::kOk);
    const auto found = keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, result.pose));
    const auto true_ones = keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, truth));
    for (int k : {kLeftAnkle, kRightAnkle}) furthest = std::max(furthest, (found[k] - true_ones[k]).norm());
  }
  return furthest;
}

TEST(PoseStage, AgainstANetworkThatInsistsThePictureDecides) {
  test::on_every_device([](ocl::DeviceContext& device) {
    EXPECT_LT(exchanged_feet_mm(device, true, 2), test::kExchangedFeetMm / 2);
    EXPECT_GT(exchanged_feet_mm(device, false, 2), test::kExchangedFeetMm);
  });
}

// Walking, seen from the side; stride: rad that the left leg is ahead.
Pose striding(const Actor& actor, double stride) {
  Pose pose = test::standing_pose(actor, M_PI / 2);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    if (actor.skeleton.dofs[k].name == "left_hip_x") pose.angles_rad[k] = -stride / 2;
    if (actor.skeleton.dofs[k].name == "right_hip_x") pose.angles_rad[k] = stride / 2;
  }
  return pose;
}

// Furthest that a foot is from where it is, mm, in each of two frames on end that begin with the legs taken for each
// other. With the default E_temporal the picture would decide at once; here it holds them there. missed: between the
// two there is a frame that shows nobody.
std::array<double, 2> taken_for_each_other_mm(ocl::DeviceContext& device, bool missed) {
  Seen seen(device);
  TrackerOptions options;
  options.pose.weights.temporal *= 3;
  PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
  const Pose truth = striding(seen.actor, 1.0);
  const auto wanted = keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, truth));
  Pose before = striding(seen.actor, -1.0);
  std::array<double, 2> furthest{};
  for (double& foot : furthest) {
    before = seen.track(stage, before, truth).pose;
    const auto found = keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, before));
    for (int k : {kLeftAnkle, kRightAnkle}) foot = std::max(foot, (found[k] - wanted[k]).norm());
    if (missed) stage.miss_frame();
  }
  return furthest;
}

// E_temporal holds them there, but not for long where the picture says otherwise: one frame may be the network's
// mistake.
TEST(PoseStage, LegsTakenForEachOtherAreFoundAnew) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto [first, second] = taken_for_each_other_mm(device, false);
    EXPECT_GT(first, test::kExchangedFeetMm);
    EXPECT_LT(second, test::kExchangedFeetMm);
  });
}

// Facing the camera, the left leg aside by so much, rad.
Pose aside(const Actor& actor, double rad) {
  Pose pose = test::standing_pose(actor, 0);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "left_hip_z") pose.angles_rad[k] = rad;
  return pose;
}

// Legs crossed, and the left one was left on the right one's shoe: E_temporal holds it there, though by either name the
// detections are elsewhere.
TEST(PoseStage, ALegLeftOnTheOtherOnesShoeIsFound) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Seen seen(device);
    TrackerOptions options;
    options.pose.weights.temporal *= 4;
    PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
    const auto ankles = [&](const Pose& pose) {
      return keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, pose));
    };
    const auto apart_mm = [&](double rad) {
      const auto at = ankles(aside(seen.actor, rad));
      return (at[kLeftAnkle] - at[kRightAnkle]).norm();
    };
    const double outwards = apart_mm(0.2) > apart_mm(-0.2) ? 1 : -1;
    const Pose truth = aside(seen.actor, 0.25 * outwards), before = aside(seen.actor, -0.22 * outwards);
    EXPECT_LT(apart_mm(-0.22 * outwards), 60);
    const auto wanted = ankles(truth), found = ankles(seen.track(stage, before, truth).pose);
    for (int k : {kLeftAnkle, kRightAnkle}) EXPECT_LT((found[k] - wanted[k]).norm(), test::kExchangedFeetMm) << k;
  });
}

// The left arm raised by so much, rad; lowered, its hand lies before the trunk.
Pose reaching(const Actor& actor, double rad) {
  Pose pose = test::standing_pose(actor, 0.3);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "left_shoulder_z") pose.angles_rad[k] += rad;
  return pose;
}

// A turn hid the arm, and E_temporal holds it at the trunk since.
TEST(PoseStage, AnArmThatIsHeldAtTheTrunkIsFoundAgain) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto wrist_off_mm = [&](double strayed_arm_share) {
      Seen seen(device);
      TrackerOptions options;
      options.pose.weights.temporal *= 8;
      options.starts.strayed_arm_share = strayed_arm_share;
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      const auto wrist = [&](const Pose& pose) {
        return keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, pose))[kLeftWrist];
      };
      const Pose truth = reaching(seen.actor, 0.5), before = reaching(seen.actor, -0.9);
      const Eigen::Vector3d off = wrist(seen.track(stage, before, truth).pose) - wrist(truth);
      return off.head<2>().norm();
    };
    EXPECT_LT(wrist_off_mm(TrackerOptions().starts.strayed_arm_share), test::kFoundArmMm);
    EXPECT_GT(wrist_off_mm(0), 3 * test::kFoundArmMm);
  });
}

// Tracked from an upper arm that points as far away from the camera as it should point towards it.
TEST(PoseStage, AnArmThatPointsAwayFromTheCameraIsFoundAgain) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto elbow_off_mm = [&](double strayed_arm_depth_mm) {
      Seen seen(device);
      TrackerOptions options;
      options.pose.weights.temporal = 0;
      options.rounds.match_levels = {0};  // coarser ones find it by themselves
      options.starts.strayed_arm_depth_mm = strayed_arm_depth_mm;
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      const auto pointing = [&](double rad) {
        Pose pose = test::standing_pose(seen.actor, 0);
        for (int k = 0; k < seen.actor.skeleton.n_dofs(); ++k)
          if (seen.actor.skeleton.dofs[k].name == "right_shoulder_y") pose.angles_rad[k] = rad;
        return pose;
      };
      const auto elbow = [&](const Pose& pose) -> Eigen::Vector3d {
        return keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, pose))[kRightElbow];
      };
      const Pose truth = pointing(-0.8), before = pointing(0.8);
      return (elbow(seen.track(stage, before, truth).pose) - elbow(truth)).norm();
    };
    EXPECT_LT(elbow_off_mm(TrackerOptions().starts.strayed_arm_depth_mm), test::kFoundArmMm);
    EXPECT_GT(elbow_off_mm(1e6), 2 * test::kFoundArmMm);
  });
}

// What draws a hidden arm to where it was is the old pose's alone: another one, found anew, is not better for it.
TEST(PoseStage, AHiddenArmThatIsHeldIsNotFoundAnewForThat) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Seen seen(device);
    TrackerOptions options;
    options.lost_error_fraction = 0;  // every frame is doubted
    options.starts.strayed_arm_share = 0;
    options.starts.leans_rad = {};
    options.shares.foot_share = 1;  // nothing is solved once more in the end
    PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
    const Pose truth = reaching(seen.actor, 0.5), before = reaching(seen.actor, 0.15);
    const Silhouette silhouette = seen.take_picture(stage, truth);
    Detections detections = test::exact_detections(seen.actor, seen.camera, truth);
    for (int k : {kLeftElbow, kLeftWrist, kLeftHand}) detections.keypoints[k].confidence = 0;
    const PoseStageInput input{detections, silhouette, seen.frame};
    stage.set_picture(input);
    const PoseResult once = stage.solve_tracked(input, before, before);
    const PoseResult twice = stage.solve_tracked(input, before, before), anew = stage.find(input);
    EXPECT_EQ(twice.pose.angles_rad, once.pose.angles_rad);
    EXPECT_NE(anew.pose.angles_rad, once.pose.angles_rad);
    EXPECT_GT(once.energy.total() - once.energy.temporal, anew.energy.total()) << "it is dearer by what holds it";
  });
}

// Where nobody is detected, what is expected is known with little confidence; nothing hides.
TEST(PoseStage, NobodyDetectedHidesNoArm) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto angles_rad = [&](bool detected, double hidden_share) {
      Seen seen(device);
      TrackerOptions options;
      options.pose.hidden_confidence = 1;
      options.pose.hidden_share = hidden_share;
      options.starts.strayed_arm_share = 0;
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      const Pose before = reaching(seen.actor, 0), truth = reaching(seen.actor, 0.1);
      const Silhouette silhouette = seen.take_picture(stage, truth);
      const Detections expected = expected_detections(seen.actor, seen.camera, before, 0.3f);
      const PoseStageInput input{expected, silhouette, seen.frame, detected};
      stage.set_picture(input);
      return stage.solve_tracked(input, before, before).pose.angles_rad;
    };
    const double share = PoseOptions().hidden_share;
    EXPECT_EQ(angles_rad(false, share), angles_rad(false, 0));
    EXPECT_NE(angles_rad(true, share), angles_rad(true, 0));
  });
}

// With the pelvis turned under a chest that is as it was.
Pose twisted(const Actor& actor, Pose pose, double twist_rad) {
  pose.root_rotation = rotation_from_vector(Eigen::Vector3d(0, twist_rad, 0)) * pose.root_rotation;
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "chest_y") pose.angles_rad[k] = twist_rad;
  return pose;
}

// Tracked from a pelvis that is a stripe too far round under a chest that is right.
TEST(PoseStage, ATwistedSpineIsAlsoSolvedStraight) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    constexpr double kTwistRad = -0.7;
    const auto facing_error = [&](double least_twist_rad) {
      Seen seen(device);
      TrackerOptions options;
      options.starts.least_twist_rad = least_twist_rad;
      options.pose.steps = 1;  // not enough to turn back
      options.rounds.match_levels = {0};
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      const Pose truth = test::standing_pose(seen.actor, 0.3);
      const Pose found = seen.track(stage, twisted(seen.actor, truth, kTwistRad), truth).pose;
      return vector_from_rotation(found.root_rotation * truth.root_rotation.transpose()).norm();
    };
    // (Stiff feet turn it back by half in one step, which is less than an actor's own twist may be.)
    EXPECT_LT(facing_error(0.1), test::kUntwistedRad);
    EXPECT_GT(facing_error(std::numbers::pi), test::kStillTwistedRad);
  });
}

// A twist that lasts is tried again, but not in every frame.
TEST(PoseStage, ATwistThatLastsIsTriedEverySoManyFrames) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    Seen seen(device);
    TrackerOptions options;
    options.starts.twisted_frames = 3;
    options.pose.steps = 1;  // not enough to turn back
    options.rounds.match_levels = {0};
    PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
    const Pose truth = test::standing_pose(seen.actor, 0.3);
    std::vector<double> errors;
    for (int frame = 0; frame < 4; ++frame) {
      const Pose found = seen.track(stage, twisted(seen.actor, truth, -0.7), truth).pose;
      errors.push_back(vector_from_rotation(found.root_rotation * truth.root_rotation.transpose()).norm());
    }
    EXPECT_LT(errors[0], test::kUntwistedRad);
    EXPECT_GT(errors[1], test::kStillTwistedRad);
    EXPECT_GT(errors[2], test::kStillTwistedRad);
    EXPECT_LT(errors[3], test::kUntwistedRad);
  });
}

// Tracked from a leg that is held before the body, its toes down.
TEST(PoseStage, AFootThatStandsOnItsToesIsAlsoSolvedFromOtherLegs) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    const auto knee_off_mm = [&](double on_edge_rad, int on_edge_frames) {
      Seen seen(device);
      TrackerOptions options;
      options.starts.on_edge_rad = on_edge_rad;
      options.starts.on_edge_frames = on_edge_frames;
      options.starts.strayed_share = 0;
      options.pose.steps = 1;  // not enough to put it down
      options.rounds.match_levels = {0};
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      const Pose truth = test::standing_pose(seen.actor, 0.3);
      Pose held = truth;
      for (int k = 0; k < seen.actor.skeleton.n_dofs(); ++k) {
        const std::string& name = seen.actor.skeleton.dofs[k].name;
        if (name == "left_hip_x") held.angles_rad[k] = -1;
        if (name == "left_knee_x") held.angles_rad[k] = 1.3;
        if (name == "left_ankle_x") held.angles_rad[k] = 0.85;
      }
      const auto knee = [&](const Pose& pose) -> Eigen::Vector3d {
        return keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, pose))[kLeftKnee];
      };
      return (knee(seen.track(stage, held, truth).pose) - knee(truth)).norm();
    };
    const double at_once = knee_off_mm(0.3, 1), never = knee_off_mm(std::numbers::pi, 1), later = knee_off_mm(0.3, 2);
    EXPECT_LT(at_once, never / 3);
    EXPECT_EQ(later, never);
  });
}

// Seen for the first time by a network that has the pelvis turned under the chest.
TEST(PoseStage, WhoIsFoundTwistedIsAlsoSolvedStraight) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    const auto facing_error = [&](double least_found_twist_rad) {
      Seen seen(device);
      TrackerOptions options;
      options.starts.least_found_twist_rad = least_found_twist_rad;
      options.pose.weights.keypoint_3d *= 3;  // it insists, and
      options.pose.weights.rest = 0;          // nothing but the picture
      options.pose.first_steps = 2;           // turns it back, in steps that are not enough
      options.rounds.match_levels = {0};
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      const Pose truth = test::standing_pose(seen.actor, 0.3);
      const Detections detections = test::exact_detections(seen.actor, seen.camera, twisted(seen.actor, truth, -0.7));
      const Pose found = seen.find(stage, detections, truth).pose;
      return vector_from_rotation(found.root_rotation * truth.root_rotation.transpose()).norm();
    };
    EXPECT_LT(facing_error(TrackerOptions().starts.least_found_twist_rad), facing_error(std::numbers::pi) / 2);
  });
}

// Seen for the first time, in a squat that the network sees mirrored in depth: the knees behind the body.
TEST(PoseStage, WhoIsFoundSquattingHasTheKneesAhead) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    const auto knees_mm = [&](double cost_of_imbalance) {
      Seen seen(device);
      TrackerOptions options;
      options.starts.cost_of_imbalance = cost_of_imbalance;
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      const Pose truth = test::with_bent_legs(seen.actor, test::standing_pose(seen.actor, 0.3), -1.2, 1.6);
      Detections detections = test::exact_detections(seen.actor, seen.camera, truth);
      for (int k : {kLeftKnee, kRightKnee, kLeftAnkle, kRightAnkle}) detections.keypoints[k].z_mm *= -1;
      const auto at = [&](const Pose& pose) {
        return keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, pose));
      };
      const auto found = at(seen.find(stage, detections, truth).pose), expected = at(truth);
      return std::max((found[kLeftKnee] - expected[kLeftKnee]).norm(),
                      (found[kRightKnee] - expected[kRightKnee]).norm());
    };
    EXPECT_LT(knees_mm(TrackerOptions().starts.cost_of_imbalance), test::kFoundKneesMm);
    EXPECT_LT(knees_mm(0), test::kFoundKneesMm) << "legs of which less shows cost less";
  });
}

// On a floor that is 30 mm too high, which draws the feet nearer along the line of sight.
TEST(PoseStage, FreeLegsDoNotStandOnTheFloor) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Seen seen(device);
    PoseStage stage(device, seen.actor, seen.camera, TrackerOptions(), seen.rasterizer, seen.visibility);
    const Pose truth = test::standing_pose(seen.actor, 0);
    const Silhouette silhouette = seen.take_picture(stage, truth);
    const Detections detections = test::exact_detections(seen.actor, seen.camera, truth);
    const PoseStageInput input{detections, silhouette, seen.frame};
    const FloorFinder floor(seen.actor, {}, Floor{{0, -1, 0}, under(seen.actor, truth).distance_mm - 30});
    PoseRounds rounds(device, seen.actor, seen.camera, TrackerOptions(), floor, seen.rasterizer, seen.visibility);
    rounds.set_picture(input);
    const auto too_far_mm = [&](const Pose& pose) {
      const auto found = keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, pose)),
                 wanted = keypoint_positions(seen.actor, forward_kinematics(seen.actor.skeleton, truth));
      return (found[kLeftAnkle].z() + found[kRightAnkle].z() - wanted[kLeftAnkle].z() - wanted[kRightAnkle].z()) / 2;
    };
    Pose held = truth;
    for (int frame = 0; frame < 5; ++frame)
      held = rounds.solve(input, detections, held, &held, PoseRounds::Rounds::kOnFeet).pose.pose;
    const Pose freed = rounds.solve(input, detections, held, &held, PoseRounds::Rounds::kFreeLegs).pose.pose;
    EXPECT_LT(too_far_mm(held), -test::kFreedFeetMm);
    EXPECT_LT(std::abs(too_far_mm(freed)), test::kFreedFeetMm);
  });
}

TEST(PoseStage, LearnsTheFloorFromFreeLegs) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto found = [&](double free_legs_3d) {
      Seen seen(device);
      TrackerOptions options;
      options.rounds.free_legs_3d = free_legs_3d;
      PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
      Pose pose = turned(seen.actor, 2);
      const Silhouette silhouette = seen.take_picture(stage, pose);
      const Detections detections = test::exact_detections(seen.actor, seen.camera, pose, 0.97);
      const PoseStageInput input{detections, silhouette, seen.frame};
      stage.set_picture(input);
      for (int frame = 0; frame < 20; ++frame) {
        const Pose before = std::exchange(pose, stage.solve_tracked(input, pose, pose).pose);
        stage.learn(input, &before, pose);
      }
      return pose.angles_rad;
    };
    EXPECT_NE(found(TrackerOptions().rounds.free_legs_3d), found(0));
  });
}

// The light is three quarters of that in which the actor's colours look as they are.
TEST(PoseStage, LearnsHowTheActorIsLit) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Seen seen(device);
    seen.brightness = 0.75f;
    TrackerOptions options;
    options.actor_light.least_frames = 0.5;
    PoseStage stage(device, seen.actor, seen.camera, options, seen.rasterizer, seen.visibility);
    const Pose before = turned(seen.actor, 0), truth = turned(seen.actor, 1);
    const Silhouette silhouette = seen.take_picture(stage, truth);
    const Detections detections = test::exact_detections(seen.actor, seen.camera, truth);
    const PoseStageInput input{detections, silhouette, seen.frame};
    stage.set_picture(input);
    const PoseResult solved = stage.solve_tracked(input, before, before);
    EXPECT_EQ(stage.light(), Light{1}) << "not known yet";
    stage.learn(input, nullptr, solved.pose);
    const Light learned = stage.light();
    // At a normal to the right, upwards, and to the camera; a texture is finer than its vertices' colours.
    for (const Light& at :
         {Light{1, 1, 0, 0, 0, 0, 0, 1, -1}, Light{1, 0, -1, 0, 0, 0, 0, -1, -1}, Light{1, 0, 0, -1, 0, 0, 0, 0, 2}})
      EXPECT_NEAR(std::inner_product(at.begin(), at.end(), learned.begin(), 0.0), 0.72, 0.06);
    stage.lose_person();
    EXPECT_EQ(stage.light(), learned);
    stage.reset();
    EXPECT_EQ(stage.light(), Light{1});
  });
}

TEST(PoseStage, AMissedFrameEndsADoubt) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto [first, second] = taken_for_each_other_mm(device, true);
    EXPECT_GT(first, test::kExchangedFeetMm);
    EXPECT_GT(second, test::kExchangedFeetMm);
  });
}

// A quarter of four times the weight is the weight, but only where the texture is matched.
TEST(PoseStage, DetectionsInDepthCountLessWhereTheTextureIsMatched) {
  test::on_every_device([](ocl::DeviceContext& device) {
    TrackerOptions whole, quarter, quarter_of_four_times;
    whole.rounds.matched_3d = 1;
    quarter.rounds.matched_3d = quarter_of_four_times.rounds.matched_3d = 0.25;
    quarter_of_four_times.pose.weights.keypoint_3d *= 4;
    const std::vector<double> matched = energies_with(device, false, false, whole);
    EXPECT_EQ(energies_with(device, false, false, quarter_of_four_times), matched);
    EXPECT_NE(energies_with(device, false, false, quarter), matched);
    for (TrackerOptions* options : {&whole, &quarter}) options->pose.weights.match = 0;
    EXPECT_EQ(energies_with(device, false, false, quarter), energies_with(device, false, false, whole));
    for (TrackerOptions* options : {&whole, &quarter}) {
      options->pose.weights.match = 1000;
      options->rounds.match_levels.clear();
    }
    EXPECT_EQ(energies_with(device, false, false, quarter), energies_with(device, false, false, whole)) << "no rounds";
  });
}

}  // namespace
}  // namespace livecap
