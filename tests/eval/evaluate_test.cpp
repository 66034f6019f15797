// A whole comparison on folders made by hand: a capture that equals the truth, one that is shifted, one that lost
// frames.
#include "eval/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "actor/actor.h"
#include "base/text.h"
#include "export/pc2.h"
#include "image/image_io.h"
#include "livecap/camera.h"
#include "livecap/error.h"
#include "livecap/log.h"
#include "support/capture_by_hand.h"
#include "support/refusal.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

using test::kHandFrames;

class Evaluate : public test::CaptureByHand {
 protected:
  // A folder that holds nothing but a joints.csv.
  static EvalOptions other_program(const std::string& joints) {
    const fs::path out = folder_ / "other_program";
    fs::remove_all(out);
    fs::create_directories(out);
    write_file_atomically(out / "joints.csv", joints);
    return {out, folder_ / "truth", (folder_ / "actor.glb").string(), (folder_ / "camera.json").string(), {}};
  }

  // What action() says while it runs.
  template <typename Action>
  static EvalReport with_log(std::vector<std::string>& lines, Action&& action) {
    struct Sink {
      explicit Sink(std::vector<std::string>& to) {
        set_log_sink([&to](LogLevel, const std::string& line) { to.push_back(line); });
      }
      ~Sink() { set_log_sink({}); }
    };
    const Sink sink(lines);
    return action();
  }
};

TEST_F(Evaluate, TheTruthItselfIsPerfect) {
  const EvalReport report = compare({0, 0, 0, 0}, {"nobody", "initialized", "ok", "ok"});
  EXPECT_EQ(report.n_frames, 4);
  EXPECT_EQ(report.n_person, 3);
  EXPECT_EQ(report.n_tracked, 3);
  EXPECT_EQ(report.n_lost, 0);
  EXPECT_EQ(report.n_invented, 0);
  EXPECT_EQ(report.iou.n, 3);
  EXPECT_EQ(report.iou.min, 1);
  EXPECT_EQ(report.vertex_mm.n, 3 * actor_.n_vertices());
  EXPECT_EQ(report.vertex_mm.max, 0);
  EXPECT_EQ(report.joint_mm.n, 3 * 4);
  EXPECT_LT(report.joint_aligned_mm.max, test::kMillimetreFloat);
}

TEST_F(Evaluate, AShiftIsMeasuredAndAlignedAway) {
  const EvalReport report = compare({0, 0.1f, 0.1f, 0.1f}, {"nobody", "ok", "ok", "ok"});
  EXPECT_NEAR(report.vertex_mm.mean, 100, test::kMillimetreFloat);
  EXPECT_LT(report.vertex_aligned_mm.max, test::kMillimetreFloat);
  EXPECT_EQ(report.true_vertex_aligned_mm.n, report.vertex_aligned_mm.n);
  EXPECT_NEAR(report.joint_mm.mean, 100, test::kMillimetreFloat);
  EXPECT_LT(report.joint_aligned_mm.max, test::kMillimetreFloat);
  EXPECT_EQ(report.body_point_mm.mean, report.joint_mm.mean);  // the truth's own actor: the same joints
  EXPECT_EQ(report.body_point_aligned_mm.max, report.joint_aligned_mm.max);
  EXPECT_LT(report.iou.max, 0.9);
  EXPECT_GT(report.iou.min, 0.2);
}

TEST_F(Evaluate, LostFramesCount) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const EvalReport report = compare({0, nan, 0.1f, 0}, {"ok", "lost", "lost", "ok"});
  EXPECT_EQ(report.n_person, 3);
  EXPECT_EQ(report.n_tracked, 1);
  EXPECT_EQ(report.n_lost, 2);
  EXPECT_EQ(report.n_without_result, 1);
  EXPECT_EQ(report.n_invented, 1);  // frame 0 has nobody
  EXPECT_EQ(report.iou.n, 3);
  EXPECT_EQ(report.iou.min, 0);  // nothing to show counts as nothing right
  EXPECT_EQ(report.vertex_mm.n, 2 * actor_.n_vertices());
  EXPECT_NEAR(report.vertex_mm.mean, 50, test::kMillimetreFloat);  // the held frame counts
}

TEST_F(Evaluate, RefusesAnotherActor) {
  compare({0, 0, 0, 0}, {"ok", "ok", "ok", "ok"});
  try {
    evaluate({folder_ / "capture", folder_ / "truth", "builtin:skirt", "", {}});
    FAIL() << "a mesh of another size was accepted";
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("vertices.pc2"), std::string::npos) << error.what();
  }
}

// Both actors at rest in one place, their joints in theirs: the points of the body are where the joints are.
TEST_F(Evaluate, JointsOfAnotherMeshAreAlsoPointsOfTheBody) {
  compare({0, 0.1f, 0.1f, 0.1f}, {"nobody", "ok", "ok", "ok"});
  const fs::path out = folder_ / "capture";
  fs::remove(out / "vertices.pc2");
  write_file_atomically(folder_ / "other.glb", make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1400));
  const EvalOptions options{out, folder_ / "truth", (folder_ / "other.glb").string(), "", {}};
  EvalReport report = evaluate(options);
  EXPECT_TRUE(report.other_mesh);
  EXPECT_EQ(report.body_point_mm.n, 0);  // four joints do not tell how the bones turned
  const Actor other = load_actor(folder_ / "other.glb");
  std::string head = "index,pts_ms,tracked", angles = head, row, zeros;
  const PosedSkeleton rest = forward_kinematics(other.skeleton, rest_pose(other.skeleton));
  for (int bone = 0; bone < other.skeleton.n_bones(); ++bone) {
    const Eigen::Vector3d p = rest.camera_from_bone[bone].translation() / 1000;
    for (int k = 0; k < 3; ++k) {
      head += ",joint_" + other.skeleton.bones[bone].name + "_" + "xyz"[k];
      row += format(",%.9g", p[k] - (k == 1 ? 0.9 : k == 2 ? 3 : 0));
    }
  }
  for (const Dof& dof : other.skeleton.dofs) {
    angles += "," + dof.name;
    zeros += format(",%.9g", dof.rest_rad * 180 / M_PI);
  }
  for (int k = 0; k < kHandFrames; ++k) {
    head += format("\n%d,%d,1", k, 40 * k) + row;
    angles += format("\n%d,%d,1", k, 40 * k) + zeros;
  }
  write_file_atomically(out / "joints.csv", head + "\n");
  write_file_atomically(out / "angles.csv", angles + "\n");
  report = evaluate(options);
  EXPECT_EQ(report.body_point_mm.n, report.joint_mm.n);
  EXPECT_NEAR(report.body_point_mm.mean, report.joint_mm.mean, test::kOtherMeshMm);
  EXPECT_NE(eval_report_text(report).find("the same points of the body"), std::string::npos);
  EXPECT_NE(eval_report_json(report).find("\"body_point_similarity_aligned_mm\": {"), std::string::npos);
}

// The same actor with its vertices in another order is another mesh of as many vertices: compared vertex by vertex it
// would be off by half a metre, by surface points it is right.
TEST_F(Evaluate, AnotherMeshIsComparedBySurface) {
  compare({0, 0.1f, 0.1f, 0.1f}, {"nobody", "ok", "ok", "ok"});
  const EvalOptions options = with_other_mesh();
  const Actor other = load_actor(folder_ / "other.glb");
  const EvalReport report = evaluate(options);
  EXPECT_TRUE(report.other_mesh);
  EXPECT_EQ(report.vertex_mm.n, 3 * other.n_vertices());
  EXPECT_NEAR(report.vertex_mm.mean, 100, test::kOtherMeshMm);
  EXPECT_LT(report.vertex_aligned_mm.mean, test::kOtherMeshMm);
  EXPECT_LT(report.surface_mm.mean, test::kOtherMeshMm);
  EXPECT_EQ(report.true_vertex_aligned_mm.n, 3 * actor_.n_vertices());
  EXPECT_LT(report.true_vertex_aligned_mm.mean, test::kOtherMeshMm);
  EXPECT_NE(eval_report_text(report).find("another mesh"), std::string::npos);
  EvalOptions wrong = options;
  wrong.truth_actor = "builtin:skirt";
  EXPECT_THROW(evaluate(wrong), IoError);
}

TEST_F(Evaluate, TheSurfaceDistanceLeavesOutTranslation) {
  const EvalReport report = compare({0, 0.1f, 0.1f, 0.1f}, {"nobody", "ok", "ok", "ok"});
  EXPECT_FALSE(report.other_mesh);
  EXPECT_GT(report.surface_mm.n, 0);
  EXPECT_LT(report.surface_mm.max, test::kOtherMeshMm);  // translation is aligned away
}

TEST_F(Evaluate, MotionSpeedAndLimits) {
  // 25 fps. Frames 1..3 have a person; the capture moves by 0, 80, 0 mm: second difference 160 mm, 100 m/s^2.
  const EvalReport report = compare({0, 0, 0.08f, 0}, {"nobody", "ok", "ok", "ok"});
  EXPECT_NEAR(report.video_fps, 25, test::kFloatRelative * 25);
  EXPECT_EQ(report.vertex_jitter.n, actor_.n_vertices());
  EXPECT_NEAR(report.vertex_jitter.error, 100, 100 * test::kFloatRelative * 10);
  EXPECT_EQ(report.vertex_jitter.truth, 0);
  EXPECT_LT(report.vertex_jitter_centred.error, test::kMillimetreFloat);
  EXPECT_EQ(report.joint_jitter.n, 4);
  EXPECT_NEAR(report.joint_jitter.error, 100, 100 * test::kFloatRelative * 10);
  EXPECT_NEAR(report.at_limit, 1.0 / 6, test::kDoubleExact);  // the elbow in one of three frames, the knee never
  ASSERT_EQ(report.angles_at_limit.size(), 1u);
  EXPECT_EQ(report.angles_at_limit[0].first, "left_elbow_y");
  EXPECT_NEAR(report.speed.latency_p95_ms, 102.9, test::kDoubleExact);  // of 101, 102, 103
  EXPECT_TRUE(std::isnan(report.speed.latency_ms));                     // report.json has none
}

TEST_F(Evaluate, PckCountsMissingResultsAsMisses) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const EvalReport report = compare({0, nan, 0, 0}, {"nobody", "lost", "ok", "ok"});
  EXPECT_NEAR(report.pck_similarity.pck, 2.0 / 3, test::kDoubleExact);
  EXPECT_NEAR(report.pck_root.pck, 2.0 / 3, test::kDoubleExact);
  EXPECT_EQ(report.losses.lost, 1);
  EXPECT_EQ(report.losses.longest_entry, 1);
}

TEST_F(Evaluate, ErrorsOfEveryLabelAddUp) {
  const EvalReport report = compare({0, 0.1f, 0.1f, 0.1f}, {"nobody", "ok", "ok", "ok"});
  int n = 0;
  for (const LabelError& row : report.labels) {
    n += row.n_vertices;
    EXPECT_NEAR(row.direct.mean, 100, test::kMillimetreFloat) << row.label;
  }
  EXPECT_EQ(n, actor_.n_vertices());
  EXPECT_EQ(report.loose_mm.n, 0);  // trousers and t-shirt
  EXPECT_EQ(report.vertex_mean_mm.size(), size_t(actor_.n_vertices()));
}

TEST_F(Evaluate, AViewFromTheSideSeesWhatTheCameraDoesNot) {
  // Its x is the depth of the tracked camera. Masks of the true surface from there.
  ExtraView view;
  view.name = "side.json";
  view.camera = camera_;
  view.masks = folder_ / "side";
  view.view_from_camera.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  view.view_from_camera.translation() = Eigen::Vector3d(-3000, 0, 3000);
  fs::create_directories(view.masks);
  std::vector<float> camera_mm = truth_;
  for (size_t i = 0; i < camera_mm.size(); ++i) camera_mm[i] *= i % 3 == 0 ? 1000 : -1000;
  for (int frame = 1; frame < kHandFrames; ++frame) {
    write_png(render_silhouette(to_view(view, camera_mm), actor_.mesh.triangles, camera_),
              view.masks / format("%06d.png", frame));
  }
  EvalReport report = compare({0, 0, 0, 0}, {"nobody", "ok", "ok", "ok"}, {view});
  ASSERT_EQ(report.views.size(), 1u);
  EXPECT_EQ(report.views[0].iou.n, 3);
  EXPECT_EQ(report.views[0].iou.min, 1);
  // A shift along x is towards the side camera: the same outline, larger. The tracked camera sees it as a shift.
  report = compare({0, 0.1f, 0.1f, 0.1f}, {"nobody", "ok", "ok", "ok"}, {view});
  EXPECT_LT(report.views[0].iou.max, 1);
  EXPECT_GT(report.views[0].iou.min, report.iou.max);
  view.masks = folder_ / "capture";  // no masks there
  EXPECT_THROW(compare({0, 0, 0, 0}, {"nobody", "ok", "ok", "ok"}, {view}), IoError);
}

TEST_F(Evaluate, ASkeletonAloneIsJudgedByItsJoints) {
  compare({0, 0.1f, 0, 0}, {"nobody", "ok", "ok", "ok"});
  fs::remove(folder_ / "capture/vertices.pc2");
  EvalReport report = evaluate({folder_ / "capture", folder_ / "truth", "", "", {}});
  EXPECT_EQ(report.joint_mm.n, 12);
  EXPECT_EQ(report.vertex_mm.n, 0);
  EXPECT_EQ(report.iou.n, 0);
  EXPECT_EQ(report.n_without_result, 0);
  compare({0, std::numeric_limits<float>::quiet_NaN(), 0, 0}, {"nobody", "lost", "ok", "ok"});
  fs::remove(folder_ / "capture/vertices.pc2");
  report = evaluate({folder_ / "capture", folder_ / "truth", "", "", {}});
  EXPECT_EQ(report.n_without_result, 1);
}

TEST_F(Evaluate, JointsAloneAreEnoughOfAnotherProgram) {
  const EvalOptions options = other_program(
      "index,keypoint_pelvis_x,keypoint_pelvis_y,keypoint_pelvis_z,joint_left_shoulder_x,joint_left_shoulder_y,"
      "joint_left_shoulder_z,joint_right_shoulder_x,joint_right_shoulder_y,joint_right_shoulder_z,joint_left_wrist_x,"
      "joint_left_wrist_y,joint_left_wrist_z\n"
      "0,,,,,,,,,,,,\n"
      "1,0.1,0,-3,0.3,0.5,-3.1,-0.1,0.5,-2.9,0.4,0.1,-3.2\n"
      "2,0,0,-3,0.2,0.5,-3.1,-0.2,0.5,-2.9,0.3,nan,-3.2\n"  // one coordinate is not known: the wrist is missed
      "3,,,,,,,,,,,,\n");
  std::vector<std::string> lines;
  const EvalReport report = with_log(lines, [&] { return evaluate(options); });
  EXPECT_TRUE(lines.empty()) << lines[0];
  EXPECT_EQ(report.n_frames, 4);
  EXPECT_EQ(report.n_tracked, 2);
  EXPECT_EQ(report.n_lost, 1);
  EXPECT_EQ(report.n_invented, 0);
  EXPECT_EQ(report.n_without_result, 1);
  EXPECT_EQ(report.joint_mm.n, 7);
  EXPECT_NEAR(report.joint_mm.mean, 4 * 100.0 / 7, test::kMillimetreFloat);
  EXPECT_LT(report.joint_aligned_mm.max, test::kMillimetreFloat);
  EXPECT_NEAR(report.pck_similarity.pck, 7.0 / 12, test::kDoubleExact);
  EXPECT_NEAR(report.pck_root.pck, 5.0 / 9, test::kDoubleExact);
  EXPECT_NE(eval_report_text(report).find("root-aligned"), std::string::npos);

  EvalOptions unnamed = options;
  unnamed.actor.clear();
  test::expect_refused<IoError>([&] { evaluate(unnamed); }, {"report.json", "no such file", "--actor"});
  unnamed = options;
  unnamed.camera.clear();
  test::expect_refused<IoError>([&] { evaluate(unnamed); }, {"report.json", "no such file", "--camera"});

  // A run that was killed leaves both, and no report.
  unnamed.actor.clear();
  fs::copy_file(options.actor, options.capture / "actor.glb");
  fs::copy_file(options.camera, options.capture / "camera.json");
  EXPECT_EQ(evaluate(unnamed).n_tracked, 2);
  write_file_atomically(options.capture / "report.json", R"({"options": {"camera": "moved/camera.json"}})");
  test::expect_refused<IoError>([&] { evaluate(unnamed); },
                                {"moved/camera.json: no such file", "other_program/report.json names it", "--camera"});
  fs::remove(options.capture / "joints.csv");
  test::expect_refused<IoError>([&] { evaluate(unnamed); }, {"other_program: is no capture folder (no joints.csv)"});
}

TEST_F(Evaluate, MillimetresAreWarnedOf) {
  const EvalOptions options = other_program(
      "index,joint_root_x,joint_root_y,joint_root_z,joint_left_shoulder_x,joint_left_shoulder_y,joint_left_shoulder_z,"
      "joint_right_shoulder_x,joint_right_shoulder_y,joint_right_shoulder_z,joint_left_wrist_x,joint_left_wrist_y,"
      "joint_left_wrist_z\n"
      "1,0,0,-3000,200,500,-3100,-200,500,-2900,,,\n"
      "2,0,0,-3000,200,500,-3100,-200,500,-2900,,,\n"
      "3,0,0,-3000,200,500,-3100,-200,500,-2900,,,\n");
  std::vector<std::string> lines;
  const EvalReport report = with_log(lines, [&] { return evaluate(options); });
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0], (options.capture / "joints.csv").string() +
                          ": its joints are 1000 times as far from the camera as the true ones: are these mm? metres "
                          "are expected");
  const std::string text = eval_report_text(report);  // of a joint that is never known as well
  EXPECT_NE(text.find(" left_wrist -"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

// Truth in mm; either side in OpenCV's axes, in metres or not.
TEST_F(Evaluate, TruthInMillimetresAndJointsBehindTheCameraAreWarnedOf) {
  const auto joints = [](double scale, double turn) {
    const auto row = [&](int k) {
      return format("%d,%g,%g,%g,%g,%g,%g,%g,%g,%g\n", k, 0.0, 0.0, -3 * turn * scale, 0.2 * scale, 0.5 * turn * scale,
                    -3.1 * turn * scale, -0.2 * scale, 0.5 * turn * scale, -2.9 * turn * scale);
    };
    return "index,joint_root_x,joint_root_y,joint_root_z,joint_left_shoulder_x,joint_left_shoulder_y,"
           "joint_left_shoulder_z,joint_right_shoulder_x,joint_right_shoulder_y,joint_right_shoulder_z\n" +
           row(1) + row(2) + row(3);
  };
  const auto lines_of = [&](const EvalOptions& options) {
    std::vector<std::string> lines;
    with_log(lines, [&] { return evaluate(options); });
    std::erase_if(lines, [](const std::string& line) { return line.find("left_wrist") != std::string::npos; });
    return lines;
  };
  EvalOptions options = other_program(joints(1, 1));
  EXPECT_TRUE(lines_of(options).empty());
  const std::string behind =
      ": its joints are behind the camera: z is negative before it; of OpenCV's axes write (x, -y, -z)";
  const std::string csv = (options.capture / "joints.csv").string();
  EXPECT_EQ(lines_of(other_program(joints(1, -1))), std::vector<std::string>{csv + behind});

  options = other_program(joints(1, 1));
  options.truth = folder_ / "wrong_truth";
  fs::create_directories(options.truth);
  const std::string json = (options.truth / "joints.json").string();
  const std::string head = R"({"names":["Hips","LeftArm","RightArm"],"frames":[null)";
  const auto three = [](const std::string& frame) { return frame + frame + frame + "]}"; };
  write_file_atomically(json, head + three(",[[0,0,-3000],[200,500,-3100],[-200,500,-2900]]"));
  EXPECT_EQ(lines_of(options), std::vector<std::string>{json + ": its joints are 1000 times as far from the camera as "
                                                               "the captured ones: are these mm? metres are expected"});
  write_file_atomically(json, head + three(",[[0,0,3],[0.2,-0.5,3.1],[-0.2,-0.5,2.9]]"));
  EXPECT_EQ(lines_of(options), std::vector<std::string>{json + behind});
}

TEST_F(Evaluate, TimesThatCannotBeAreWarnedOf) {
  const auto lines_of = [&](const std::vector<double>& pts_ms) {
    std::string joints = "index,pts_ms,joint_root_x,joint_root_y,joint_root_z\n";
    for (int k = 1; k < kHandFrames; ++k) joints += format("%d,%.10g,0,0,-3\n", k, pts_ms[k - 1]);
    const EvalOptions options = other_program(joints);
    std::vector<std::string> lines;
    with_log(lines, [&] { return evaluate(options); });
    std::erase_if(lines, [](const std::string& line) { return line.find("pts_ms") == std::string::npos; });
    return lines;
  };
  const std::string file = (folder_ / "other_program/joints.csv").string();
  EXPECT_TRUE(lines_of({40, 80, 120}).empty());
  EXPECT_TRUE(lines_of({0, 0, 0}).empty());  // not known
  EXPECT_EQ(lines_of({0.04, 0.08, 0.12}),
            std::vector<std::string>{
                file + ": pts_ms says 2.5e+04 frames a second, expected 1 to 1000: is it in milliseconds?"});
  EXPECT_EQ(lines_of({40000, 80000, 120000}).size(), 1u);
  EXPECT_EQ(
      lines_of({80, 40, 120}),
      std::vector<std::string>{file + ": line 3: pts_ms falls from 80 to 40: frames must follow each other in time"});
}

TEST_F(Evaluate, OneLineNamesTheJointsThatACaptureLacks) {
  const EvalOptions options = other_program(
      "index,joint_neck_x,joint_neck_y,joint_neck_z,joint_left_shoulder_x,joint_left_shoulder_y,joint_left_shoulder_z,"
      "joint_right_shoulder_x,joint_right_shoulder_y,joint_right_shoulder_z,joint_left_wrist_x,joint_left_wrist_y,"
      "joint_left_wrist_z\n"
      "1,0,0.5,-3,0.2,0.5,-3.1,-0.2,0.5,-2.9,0.3,0.1,-3.2\n"
      "3,0,0.5,-3,0.2,0.5,-3.1,-0.2,0.5,-2.9,0.3,0.1,-3.2\n");
  std::vector<std::string> lines;
  const EvalReport report = with_log(lines, [&] { return evaluate(options); });
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NE(lines[0].find("joints.csv: has no columns joint_<name>_x, _y, _z of root, which"), std::string::npos)
      << lines[0];
  EXPECT_NE(lines[1].find("no row for 1 of the 3 frames"), std::string::npos) << lines[1];
  EXPECT_EQ(report.joint_mm.n, 6);
  EXPECT_NEAR(report.video_fps, 15, test::kDoubleExact);  // every second frame
  const std::string text = eval_report_text(report);
  EXPECT_EQ(text.find("root-aligned"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

// Who leaves out the frames that went wrong is told, also at the start and the end; who captured a part on purpose is
// not.
TEST_F(Evaluate, FramesThatAreLeftOutAreToldWhereverTheyAre) {
  const std::string head =
      "index,joint_root_x,joint_root_y,joint_root_z,joint_left_shoulder_x,joint_left_shoulder_y,joint_left_shoulder_z,"
      "joint_right_shoulder_x,joint_right_shoulder_y,joint_right_shoulder_z,joint_left_wrist_x,joint_left_wrist_y,"
      "joint_left_wrist_z\n";
  const EvalOptions options = other_program(head + "2,0,0,-3,0.2,0.5,-3.1,-0.2,0.5,-2.9,0.3,0.1,-3.2\n");
  const auto kinds = {"vertices.pc2", "joints.json", "masks"};  // which truth tells of persons
  for (const char* kind : kinds) {
    const fs::path truth = folder_ / "part_of_truth";
    fs::remove_all(truth);
    fs::create_directories(truth);
    fs::copy(folder_ / "truth" / kind, truth / kind, fs::copy_options::recursive);
    fs::copy_file(folder_ / "truth/joints.json", truth / "joints.json", fs::copy_options::skip_existing);
    if (std::string(kind) == "masks") fs::remove(truth / "joints.json");
    EvalOptions against = options;
    against.truth = truth;
    std::vector<std::string> lines;
    const EvalReport report = with_log(lines, [&] { return evaluate(against); });
    ASSERT_EQ(lines.size(), 1u) << kind;
    EXPECT_EQ(lines[0], options.capture.string() +
                            ": has no row for 2 of the 3 frames in which the truth has a person, which are not judged; "
                            "a row with empty cells is a frame without a result");
    EXPECT_EQ(eval_report_text(report).find("frames 1, with a person 1 of 3 in the truth: tracked"), 0u);
    EXPECT_NE(eval_report_json(report).find("\"frames_with_person_in_truth\": 3"), std::string::npos);
  }

  write_file_atomically(options.capture / "report.json", R"({"options": {"first": 2, "frames": 1}})");
  std::vector<std::string> lines;
  EvalReport report = with_log(lines, [&] { return evaluate(options); });
  EXPECT_TRUE(lines.empty()) << lines[0];
  EXPECT_EQ(eval_report_text(report).find("frames 1, with a person 1 of 3 in the truth (capture --first, --frames):"),
            0u);
  write_file_atomically(options.capture / "report.json", R"({"options": {"first": 2, "frames": -1}})");
  report = with_log(lines, [&] { return evaluate(options); });  // stopped before its end
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("no row for 1 of the 3 frames"), std::string::npos) << lines[0];
}

TEST_F(Evaluate, RowsOfAnotherFrameAreRefused) {
  const std::string row = "joint_root_x,joint_root_y,joint_root_z\n";
  test::expect_refused<IoError>([&] { evaluate(other_program("index," + row + "1,0,0,-3\n1,0,0,-3\n")); },
                                {"joints.csv: line 3", "1 does not follow 1"});
  test::expect_refused<IoError>([&] { evaluate(other_program("frame," + row + "1,0,0,-3\n")); },
                                {"joints.csv", "\"index\""});
  const EvalOptions options = other_program("index," + row + "1,0,0,-3\n2,0,0,-3\n");
  write_file_atomically(options.capture / "frames.csv", "index,status\n1,ok\n3,ok\n");
  test::expect_refused<IoError>([&] { evaluate(options); }, {"joints.csv: line 3 is of frame 2", "frame 3"});
}

// What the truth does not tell is not that nobody is there.
TEST_F(Evaluate, ATruthThatEndsEarlyIsToldOf) {
  compare({0, 0, 0, 0}, {"nobody", "ok", "ok", "ok"});
  const fs::path truth = folder_ / "short_truth";
  const auto lines_of = [&] {
    std::vector<std::string> lines;
    with_log(lines, [&] { return evaluate({folder_ / "capture", truth, "", "", {}}); });
    return lines;
  };
  fs::create_directories(truth);
  const std::string two = R"({"names":["Hips","LeftArm","RightArm","LeftHand"],"frames":[null,)"
                          R"([[0,0,-3],[0.2,0.5,-3.1],[-0.2,0.5,-2.9],[0.3,0.1,-3.2]]]})";
  write_file_atomically(truth / "joints.json", two);
  const std::string end = " for 2 of the 4 captured frames, the first of them 2; they count as frames without a person";
  EXPECT_EQ(lines_of(), std::vector<std::string>{(truth / "joints.json").string() + ": has no entry" + end});
  fs::copy_file(folder_ / "truth/vertices.pc2", truth / "vertices.pc2");
  EXPECT_EQ(lines_of(), std::vector<std::string>{(truth / "joints.json").string() +
                                                 ": has 2 frames, 2 of the captured ones come after them: their joints "
                                                 "are not judged"});
  fs::remove(truth / "joints.json");
  fs::remove(truth / "vertices.pc2");
  fs::create_directories(truth / "masks");
  for (const char* mask : {"000001.png", "000003.png"})
    fs::copy_file(folder_ / "truth/masks" / mask, truth / "masks" / mask);
  EXPECT_EQ(lines_of(), std::vector<std::string>{(truth / "masks").string() +
                                                 ": has no entry for 2 of the 4 captured frames, the first of them 0; "
                                                 "they count as frames without a person"});
  // Whether it is there cannot be known, as in a folder without permission.
  fs::create_symlink("000002.png", truth / "masks/000002.png");
  test::expect_refused<IoError>(lines_of, {"masks/000002.png: cannot be read"});
  fs::create_symlink("vertices.pc2", truth / "vertices.pc2");
  test::expect_refused<IoError>(lines_of, {"short_truth/vertices.pc2: cannot be read"});
}

TEST_F(Evaluate, StopsWhenItIsTold) {
  compare({0, 0, 0, 0}, {"nobody", "ok", "ok", "ok"});
  int n_asked = 0;
  EvalOptions options{folder_ / "capture", folder_ / "truth", "", "", {}};
  options.go_on = [&] { return ++n_asked < 3; };
  test::expect_refused<Error>([&] { evaluate(options); }, {"interrupted"});
  EXPECT_EQ(n_asked, 3);
}

TEST_F(Evaluate, RefusesATruthWithoutAnybody) {
  compare({0, 0, 0, 0}, {"nobody", "ok", "ok", "ok"});
  const fs::path empty = folder_ / "empty";
  fs::create_directories(empty);
  Pc2Writer pc2(empty / "vertices.pc2", actor_.n_vertices());
  pc2.append(std::vector<float>(truth_.size(), NAN));
  EXPECT_THROW(evaluate({folder_ / "capture", empty, "", "", {}}), IoError);
}

TEST_F(Evaluate, JsonOfANameThatIsNoUtf8) {
  EvalReport report;
  report.views.push_back({"caf\xe9.json", {}});
  EXPECT_NE(eval_report_json(report).find("\"caf\xef\xbf\xbd.json\""), std::string::npos);
}

TEST_F(Evaluate, JsonHoldsEveryFrame) {
  const std::string json = eval_report_json(compare({0, 0, 0, 0}, {"nobody", "ok", "ok", "ok"}));
  EXPECT_NE(json.find("\"joint_similarity_aligned_mm\""), std::string::npos);
  EXPECT_NE(json.find("\"index\": 3"), std::string::npos);
  EXPECT_EQ(json.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace livecap
