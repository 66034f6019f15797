// A capture made by hand, of who walks over a floor before a camera that looks down and is rolled: exported, everything
// is where it was in the room.
#include "level/level_export.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include "base/scratch_folder.h"
#include "base/text.h"
#include "export/csv.h"
#include "export/pc2.h"
#include "livecap/error.h"
#include "livecap/log.h"
#include "support/refusal.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int kFrames = 40, kStepEvery = 10;  // frames between steps; the first two frames are empty
constexpr int64_t kEmpty = 2;
constexpr double kStepM = 0.1, kCameraHeightM = 1.4, kDistanceM = 3;

class LevelExport : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / format("livecap_level_%d", static_cast<int>(::getpid()));
    fs::create_directories(folder_);
    write_file_atomically(folder_ / "actor.glb", make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1500));
    actor_ = load_actor(folder_ / "actor.glb");
    lowest_m_ = 1e9;
    for (int i = 0; i < actor_.n_vertices(); ++i)
      lowest_m_ = std::min<double>(lowest_m_, actor_.mesh.positions[3 * i + 1] / 1000);
    camera_ = camera_from_fov(540, 960, 45);
    camera_.cx += 12;
    save_camera(camera_, folder_ / "camera.json");
    write_file_atomically(folder_ / "report.json",
                          R"({"options":{"actor":")" + (folder_ / "actor.glb").string() + R"(","height_mm":0}})");
    Pc2Writer pc2(folder_ / "vertices.pc2", actor_.n_vertices());
    JointsCsvWriter joints(folder_ / "joints.csv", actor_);
    AnglesCsvWriter angles(folder_ / "angles.csv", actor_.skeleton);
    std::string frames = "index,pts_ms,status,latency_ms\n";
    for (int64_t k = 0; k < kFrames; ++k) {
      const bool tracked = k >= kEmpty;
      frames += format("%d,%g,%s,0\n", int(k), 40.0 * double(k), tracked ? "ok" : "nobody");
      pc2.append(camera_vertices_m(k));
      if (tracked) {
        joints.append(k, 40.0 * double(k), true, camera_pose(k));
        angles.append(k, 40.0 * double(k), true, camera_pose(k));
      } else {
        joints.append_missing(k, 40.0 * double(k));
        angles.append_missing(k, 40.0 * double(k));
      }
    }
    write_file_atomically(folder_ / "frames.csv", frames);
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  // The room: metres, y up, 0 on the floor, the origin where the person is first; the camera's axes are turned about a
  // horizontal line.
  static Eigen::Isometry3d camera_in_room() {
    const Vector3d line = Vector3d(1, 0, 0.3).normalized();
    return Eigen::Translation3d(0.2, kCameraHeightM, kDistanceM) * Eigen::AngleAxisd(-0.3, line) *
           Eigen::AngleAxisd(M_PI, Vector3d::UnitX());
  }
  static Vector3d rest_in_room(const Vector3d& rest_m, int64_t k) {
    const Vector3d root = actor_.skeleton.root_rest_mm / 1000;
    const double step = kStepM * double((k - kEmpty) / kStepEvery);
    return rest_m - Vector3d(root.x(), lowest_m_, root.z()) + Vector3d(step, 0, 0);
  }
  static Vector3d vertex_in_room(int i, int64_t k) {
    return rest_in_room(Vector3d(Eigen::Vector3f::Map(&actor_.mesh.positions[3 * i]).cast<double>() / 1000), k);
  }
  static Pose camera_pose(int64_t k) {
    Pose pose = rest_pose(actor_.skeleton);
    const Eigen::Isometry3d from_room = camera_in_room().inverse();
    pose.root_translation_mm = 1000 * (from_room * rest_in_room(pose.root_translation_mm / 1000, k));
    pose.root_rotation = from_room.linear() * pose.root_rotation;
    return pose;
  }
  static std::vector<float> camera_vertices_m(int64_t k) {
    std::vector<float> vertices;
    for (int i = 0; i < actor_.n_vertices(); ++i) {
      const Vector3d p = camera_in_room().inverse() * vertex_in_room(i, k);
      for (double value : {p.x(), -p.y(), -p.z()}) vertices.push_back(float(value));
    }
    return vertices;
  }
  static void measure_floor() {
    Camera camera = camera_;
    const Vector3d up = camera_in_room().linear().transpose() * Vector3d::UnitY();
    camera.floor = FloorPlane{{up.x(), up.y(), up.z()}, 1000 * kCameraHeightM};
    save_camera(camera, folder_ / "measured.json");
  }
  static LevelExportOptions options(const char* out, bool measured = true) {
    LevelExportOptions options;
    options.capture = folder_;
    options.out = {folder_ / out};
    if (!measured) return options;
    measure_floor();
    options.floor = (folder_ / "measured.json").string();
    return options;
  }
  template <typename E>
  static void expect_refused(const LevelExportOptions& asked, const std::vector<std::string>& words) {
    test::expect_refused<E>([&] { export_level(asked); }, words);
  }

  static inline fs::path folder_;
  static inline Actor actor_;
  static inline Camera camera_;
  static inline double lowest_m_ = 0;
};

TEST_F(LevelExport, PutsVerticesWhereTheyWereInTheRoom) {
  const LevelExportReport report = export_level(options("up.pc2"));
  EXPECT_EQ(report.floor, FloorSource::kMeasured);
  EXPECT_EQ(report.frames, kFrames);
  EXPECT_EQ(report.tracked, kFrames - kEmpty);
  EXPECT_NEAR(report.camera_height_mm, 1000 * kCameraHeightM, test::kHandComputed);
  const Vector3d axis = camera_in_room().linear().col(2), right = camera_in_room().linear().col(0);
  EXPECT_NEAR(std::sin(report.tilt.down_deg * M_PI / 180), -axis.y(), test::kDoubleExact);
  EXPECT_NEAR(std::tan(report.tilt.roll_deg * M_PI / 180), right.y() / -camera_in_room().linear()(1, 1),
              test::kDoubleExact);

  const Pc2 pc2 = read_pc2(folder_ / "up.pc2");
  ASSERT_EQ(pc2.n_samples, kFrames);
  for (const int k : {2, 11, 12, 39})
    for (int i = 0; i < actor_.n_vertices(); ++i)
      EXPECT_LT((Eigen::Vector3f::Map(&pc2.sample(k)[3 * i]).cast<double>() - vertex_in_room(i, k)).norm(),
                test::kFloatChain);
  for (int i = 0; i < 3; ++i)  // before anybody came
    EXPECT_NEAR(pc2.sample(0)[i], actor_.mesh.positions[i] / 1000, test::kFloatChain);
}

TEST_F(LevelExport, PutsTheSkeletonThereToo) {
  LevelExportOptions asked = options("up.bvh");
  asked.bvh_unit_m = 1;
  asked.first = 12;
  asked.frames = 20;
  EXPECT_EQ(export_level(asked).tracked, 20);
  std::ifstream file(folder_ / "up.bvh");
  std::string line;
  while (std::getline(file, line) && line != "MOTION") continue;
  std::getline(file, line);
  EXPECT_NE(line.find("20"), std::string::npos);
  std::getline(file, line);
  for (int k = 12; k < 32; ++k) {
    ASSERT_TRUE(std::getline(file, line));
    std::istringstream numbers(line);
    Vector3d root, zxy;
    for (int i = 0; i < 3; ++i) numbers >> root[i];
    for (int i = 0; i < 3; ++i) numbers >> zxy[i];
    const Vector3d first = rest_in_room(actor_.skeleton.root_rest_mm / 1000, 12);
    const Vector3d expected = rest_in_room(actor_.skeleton.root_rest_mm / 1000, k) - Vector3d(first.x(), 0, first.z());
    EXPECT_LT((root - expected).norm(), test::kFloatChain);
    EXPECT_LT(zxy.norm(), test::kFloatTurn * 180 / M_PI);  // at rest the root's axes are the room's
  }
}

// Before anybody came the skeleton stands where the template of the .pc2 does.
TEST_F(LevelExport, TheSkeletonStandsBeforeAnybodyCame) {
  LevelExportOptions asked = options("before.bvh");
  asked.bvh_unit_m = 1;
  export_level(asked);
  std::ifstream file(folder_ / "before.bvh");
  std::string line;
  while (std::getline(file, line) && !line.starts_with("Frame Time")) continue;
  for (int k = 0; k < kEmpty; ++k) {
    ASSERT_TRUE(std::getline(file, line));
    std::istringstream numbers(line);
    Vector3d root, zxy;
    for (int i = 0; i < 3; ++i) numbers >> root[i];
    for (int i = 0; i < 3; ++i) numbers >> zxy[i];
    EXPECT_LT((root - actor_.skeleton.root_rest_mm / 1000).norm(), test::kFloatChain) << line;
    EXPECT_LT(zxy.norm(), test::kFloatTurn * 180 / M_PI) << line;
  }
}

// BVH and PC2 know one rate, which a capture of a phone has not.
TEST_F(LevelExport, FramesThatComeUnevenlyAreTold) {
  const fs::path uneven = folder_ / "uneven";
  fs::create_directories(uneven);
  for (const char* file : {"camera.json", "report.json", "joints.csv", "angles.csv"})
    fs::copy_file(folder_ / file, uneven / file);
  std::string frames = "index,pts_ms,status,latency_ms\n";
  for (int k = 0; k < kFrames; ++k)
    frames += format("%d,%d,%s,0\n", k, k < 9 ? 40 * k : 40 * k + 90, k < 2 ? "nobody" : "ok");
  write_file_atomically(uneven / "frames.csv", frames);
  const auto lines_of = [&](const char* out) {
    LevelExportOptions asked = options(out);
    asked.capture = uneven;
    std::vector<std::string> lines;
    set_log_sink([&](LogLevel, const std::string& line) { lines.push_back(line); });
    export_level(asked);
    set_log_sink({});
    return lines;
  };
  EXPECT_EQ(lines_of("uneven.bvh"),
            std::vector<std::string>{uneven.string() +
                                     ": its frames do not come evenly at 25 a second; a .glb has their "
                                     "times, in " +
                                     (folder_ / "uneven.bvh").string() + " they follow each other at that rate"});
  EXPECT_TRUE(lines_of("uneven.glb").empty());
}

TEST_F(LevelExport, GlbHasTheCameraThatCapturedIt) {
  export_level(options("up.glb"));
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  ASSERT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, (folder_ / "up.glb").string())) << error;
  EXPECT_EQ(error + warning, "");
  ASSERT_EQ(model.cameras.size(), 1u);
  const auto node = std::find_if(model.nodes.begin(), model.nodes.end(), [](const auto& n) { return n.camera == 0; });
  ASSERT_NE(node, model.nodes.end());
  const int index = int(node - model.nodes.begin());
  EXPECT_TRUE(std::ranges::count(model.scenes[0].nodes, index));
  const Eigen::Isometry3d camera = camera_in_room();
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(node->translation[i], camera.translation()[i], test::kFloatChain);
  const Eigen::Quaterniond turn(node->rotation[3], node->rotation[0], node->rotation[1], node->rotation[2]);
  // glTF 2.0, 3.10: a camera looks along -z, +x is right.
  EXPECT_LT((turn * -Vector3d::UnitZ() - camera.linear().col(2)).norm(), test::kFloatChain);
  EXPECT_LT((turn * Vector3d::UnitX() - camera.linear().col(0)).norm(), test::kFloatChain);
  const auto& lens = model.cameras[0].perspective;
  EXPECT_NEAR(std::tan(lens.yfov / 2), camera_.height / 2.0 / camera_.fy, test::kDoubleExact);
  EXPECT_NEAR(lens.aspectRatio * std::tan(lens.yfov / 2), camera_.width / 2.0 / camera_.fx, test::kDoubleExact);
  EXPECT_NEAR(model.cameras[0].extras.Get("livecap").Get("cx").GetNumberAsDouble(), camera_.cx, test::kDoubleExact);
  EXPECT_EQ(load_actor(folder_ / "up.glb").n_vertices(), actor_.n_vertices());
}

TEST_F(LevelExport, FindsTheFloorBelowFeetAtRest) {
  const LevelExportReport report = export_level(options("up.pc2", false));
  EXPECT_EQ(report.floor, FloorSource::kFeet);
  EXPECT_NEAR(report.tilt.down_deg, std::asin(-camera_in_room().linear()(1, 2)) * 180 / M_PI,
              test::kLearnedFloorRad * 180 / M_PI);
  const Pc2 pc2 = read_pc2(folder_ / "up.pc2");
  float lowest = 1e9f;
  for (size_t i = 1; i < pc2.sample(20).size(); i += 3) lowest = std::min(lowest, pc2.sample(20)[i]);
  EXPECT_NEAR(lowest, 0, test::kLearnedFloorMm / 1000);
}

// Its height is that of the feet all the same.
TEST_F(LevelExport, TheTiltIsThatOfTheFloorInTheReport) {
  const ScratchFolder copy;
  fs::copy(folder_, copy / "capture", fs::copy_options::recursive);
  LevelExportOptions asked = options("up.pc2", false);
  asked.capture = copy / "capture";
  const std::string report_json = read_file(folder_ / "report.json");
  const auto with_floor = [&](const std::string& floor) {
    write_file_atomically(copy / "capture/report.json",
                          report_json.substr(0, report_json.rfind('}')) + R"(,"floor":)" + floor + "}");
  };
  const double down = 0.2;
  const Vector3d up(0, -std::cos(down), -std::sin(down));
  with_floor(format(R"({"normal":[0,%.17g,%.17g],"distance_mm":900})", up.y(), up.z()));
  const LevelExportReport report = export_level(asked);
  EXPECT_EQ(report.floor, FloorSource::kFeet);
  EXPECT_NEAR(report.tilt.down_deg, down * 180 / M_PI, test::kGivenTiltDeg);
  double height_mm = 0;  // over the lowest vertex, mean
  for (int64_t k = kEmpty; k < kFrames; ++k) {
    double highest = 0;
    const std::vector<float> vertices = camera_vertices_m(k);  // glTF's axes
    for (size_t i = 0; i < vertices.size(); i += 3)
      highest = std::max(highest, -1000 * up.dot(Vector3d(vertices[i], -vertices[i + 1], -vertices[i + 2])));
    height_mm += highest / (kFrames - kEmpty);
  }
  EXPECT_NEAR(report.camera_height_mm, height_mm, test::kHeightOverFeetMm);

  const double learned_deg = std::asin(-camera_in_room().linear()(1, 2)) * 180 / M_PI;
  for (const char* none : {"null", R"({"normal":[1,0,0],"distance_mm":900})"}) {
    with_floor(none);
    EXPECT_NEAR(export_level(asked).tilt.down_deg, learned_deg, test::kLearnedFloorRad * 180 / M_PI) << none;
  }
  for (const auto& [floor, named] : {std::pair{"900", "field \"floor\" must be"},
                                     std::pair{R"({"normal":[0,0.96,0.28],"distance_mm":900})", "points down"}}) {
    with_floor(floor);
    expect_refused<IoError>(asked, {"report.json", named});
  }
}

TEST_F(LevelExport, TakesTheCameraToBeLevelWhenAsked) {
  LevelExportOptions asked = options("up.pc2", false);
  asked.level_camera = true;
  const LevelExportReport report = export_level(asked);
  EXPECT_EQ(report.floor, FloorSource::kLevelCamera);
  EXPECT_EQ(report.tilt.down_deg, 0);
  const Pc2 up = read_pc2(folder_ / "up.pc2"), own = read_pc2(folder_ / "vertices.pc2");
  for (size_t i = 0; i < up.sample(5).size(); ++i)  // only moved
    EXPECT_NEAR(up.sample(5)[i] - up.sample(5)[i % 3], own.sample(5)[i] - own.sample(5)[i % 3], test::kFloatChain);
}

// Stopped in the second of three files: the first is whole, the others are what they were.
TEST_F(LevelExport, AStoppedExportLeavesOldFilesAsTheyWere) {
  for (const char* second : {"second.bvh", "second.pc2", "second.glb"}) {
    LevelExportOptions asked = options("first.bvh");
    asked.out.insert(asked.out.end(), {folder_ / second, folder_ / "third.pc2"});
    for (const char* name : {"first.bvh", second, "third.pc2"}) write_file_atomically(folder_ / name, "old");
    int n_asked = 0;
    EXPECT_EQ(export_level(asked, [&] { return ++n_asked < kFrames + kFrames / 2; }).files, 1u);
    EXPECT_NE(read_file(folder_ / "first.bvh"), "old");
    EXPECT_EQ(read_file(folder_ / second), "old");
    EXPECT_EQ(read_file(folder_ / "third.pc2"), "old");
    EXPECT_FALSE(fs::exists(folder_ / (std::string(second) + ".part")));
    EXPECT_EQ(export_level(asked, [] { return true; }).files, 3u);
    EXPECT_NE(read_file(folder_ / second), "old");
  }
}

TEST_F(LevelExport, ACaptureOfNobodyIsSaidToBeThat) {
  const fs::path empty = folder_ / "of_nobody";
  fs::create_directories(empty);
  for (const char* file : {"camera.json", "report.json", "joints.csv", "angles.csv", "vertices.pc2"})
    fs::copy_file(folder_ / file, empty / file);
  write_file_atomically(empty / "frames.csv", "index,pts_ms,status\n0,0,nobody\n1,40,lost\n");
  LevelExportOptions asked = options("nobody.glb", false);
  asked.capture = empty;
  expect_refused<IoError>(asked, {"of_nobody/frames.csv: nobody was tracked in any frame"});
}

TEST_F(LevelExport, RefusesVerticesThatAreCutOff) {
  const fs::path cut = folder_ / "cut";
  fs::create_directories(cut);
  for (const char* file : {"camera.json", "report.json", "frames.csv", "joints.csv", "angles.csv"})
    fs::copy_file(folder_ / file, cut / file);
  {
    Pc2Writer pc2(cut / "vertices.pc2", actor_.n_vertices());
    for (int64_t k = 0; k < kFrames / 2; ++k) pc2.append(camera_vertices_m(k));
  }
  for (const char* out : {"cut.pc2", "cut.glb"}) {
    LevelExportOptions asked = options(out);
    asked.capture = cut;
    expect_refused<IoError>(asked, {"cut/vertices.pc2: has 20 samples, frames.csv 40 rows"});
    EXPECT_FALSE(fs::exists(folder_ / out)) << out;
    asked.frames = kFrames / 2;  // as far as it goes
    EXPECT_EQ(export_level(asked).frames, kFrames / 2);
  }
  LevelExportOptions asked = options("cut.bvh");  // needs none
  asked.capture = cut;
  EXPECT_EQ(export_level(asked).frames, kFrames);
}

TEST_F(LevelExport, RefusesWhatItCannotExport) {
  expect_refused<ConfigError>(options("up.fbx"), {"up.fbx", ".glb, .bvh or .pc2"});
  LevelExportOptions asked = options("first.glb");
  asked.out.push_back(folder_ / "second.fbx");
  expect_refused<ConfigError>(asked, {"second.fbx", ".glb, .bvh or .pc2"});
  EXPECT_FALSE(fs::exists(folder_ / "first.glb"));
  fs::copy_file(folder_ / "vertices.pc2", folder_ / "kept.pc2");
  expect_refused<ConfigError>(options("vertices.pc2"), {"vertices.pc2", "would be overwritten", "--out"});
  EXPECT_EQ(read_file(folder_ / "vertices.pc2"), read_file(folder_ / "kept.pc2"));
  for (const char* name : {"motion.bvh", "capture.glb"}) {  // of the capture, though nothing reads them
    write_file_atomically(folder_ / name, "kept");
    expect_refused<ConfigError>(options(name), {name, "would be overwritten", "--out"});
    EXPECT_EQ(read_file(folder_ / name), "kept");
  }
  asked = options("twice.glb");
  asked.out.push_back(folder_ / "twice.glb");
  expect_refused<ConfigError>(asked, {"twice.glb", "two results"});
  ASSERT_EQ(::mkfifo((folder_ / "pipe.bvh").c_str(), 0600), 0);
  expect_refused<IoError>(options("pipe.bvh"), {"pipe.bvh", "is a pipe"});
  asked = options("up.glb");
  asked.floor = (folder_ / "camera.json").string();
  expect_refused<IoError>(asked, {"camera.json", "tells no floor", "calibrate --floor"});
  asked = options("up.glb");
  asked.frames = kEmpty;
  expect_refused<IoError>(asked, {"frames.csv", "nobody was tracked"});
  asked = options("up.glb");
  const fs::path other = folder_ / "other";
  fs::create_directories(other);
  for (const char* file : {"camera.json", "report.json", "frames.csv", "joints.csv"})
    fs::copy_file(folder_ / file, other / file);
  asked.capture = other;
  expect_refused<IoError>(asked, {"other/angles.csv", "missing"});
  fs::copy_file(folder_ / "angles.csv", other / "angles.csv");
  asked.out = {folder_ / "up.pc2"};
  expect_refused<IoError>(asked, {"other/vertices.pc2", "missing"});
  asked.out = {folder_ / "skeleton.glb"};
  EXPECT_EQ(export_level(asked).tracked, kFrames - kEmpty);
}

}  // namespace
}  // namespace livecap
