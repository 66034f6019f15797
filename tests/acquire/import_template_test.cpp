#include "acquire/import_template.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>

#include "acquire/skeletool_template.h"
#include "acquire/template_truth.h"
#include "acquire/vertex_labels.h"
#include "base/text.h"
#include "eval/capture_folder.h"
#include "eval/joint_names.h"
#include "eval/truth_folder.h"
#include "livecap/error.h"
#include "support/refusal.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap::acquire {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

class ImportTemplate : public testing::Test {
 protected:
  ImportTemplate() : folder_(fs::path(testing::TempDir()) / "import_template_test") {
    fs::remove_all(folder_);
    source().write(folder_);
  }
  ~ImportTemplate() override { fs::remove_all(folder_); }

  static const test::SkeletoolTemplate& source() {
    static const test::SkeletoolTemplate made;
    return made;
  }
  TemplateFiles files() const {
    return {folder_ / "template.skeleton", folder_ / "template.skin",
            folder_ / "template.obj",      {},
            folder_ / "segmentation.txt",  {}};
  }
  fs::path write(const char* name, const std::string& text) const {
    write_file_atomically(folder_ / name, text);
    return folder_ / name;
  }
  static std::string edited(std::string text, const std::string& from, const std::string& to) {
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  }
  static Actor loaded(const ImportedTemplate& imported) {
    return load_actor_bytes(meshing::actor_glb(imported.actor), "imported");
  }
  // The same built-in actor by its own file.
  static const Actor& original() {
    static const Actor actor = load_actor_bytes(meshing::actor_glb(synth::actor_file(source().model)), "original");
    return actor;
  }

  fs::path folder_;
};

// Written as a data set's template and imported, the built-in actor is what it was: mesh, rig, weights, materials,
// texture, keypoints.
TEST_F(ImportTemplate, IsTheActorThatTheTemplateWasMadeOf) {
  const ImportedTemplate imported = import_template(files(), "template");
  const Actor actor = loaded(imported);
  const Actor& truth = original();
  ASSERT_EQ(actor.n_vertices(), truth.n_vertices());
  EXPECT_EQ(actor.mesh.triangles, truth.mesh.triangles);
  // The pelvis is put above the origin, whatever the template's world.
  const Vector3d pelvis = truth.skeleton.root_rest_mm, shift(-pelvis.x(), 0, -pelvis.z());
  EXPECT_LT((actor.skeleton.root_rest_mm - pelvis - shift).norm(), test::kMillimetreFloat);
  for (size_t i = 0; i < truth.mesh.positions.size(); ++i)
    ASSERT_NEAR(actor.mesh.positions[i], truth.mesh.positions[i] + shift[i % 3], test::kMillimetreFloat) << i;
  ASSERT_EQ(actor.skeleton.n_bones(), truth.skeleton.n_bones());
  ASSERT_EQ(actor.skeleton.n_dofs(), truth.skeleton.n_dofs());
  for (int b = 0; b < truth.skeleton.n_bones(); ++b) {
    EXPECT_EQ(actor.skeleton.bones[b].name, truth.skeleton.bones[b].name);
    EXPECT_LT((actor.skeleton.bones[b].offset_mm - truth.skeleton.bones[b].offset_mm).norm(), test::kMillimetreFloat)
        << truth.skeleton.bones[b].name;
  }
  for (int k = 0; k < truth.skeleton.n_dofs(); ++k)
    EXPECT_NEAR(actor.skeleton.dofs[k].rest_rad, truth.skeleton.dofs[k].rest_rad, test::kFloatChain);
  for (int v = 0; v < truth.n_vertices(); ++v)
    for (int b = 0; b < truth.skeleton.n_bones(); ++b) {
      const auto weight = [&](const Actor& of) {
        double sum = 0;
        for (int k = 0; k < kMaxInfluences; ++k)
          if (of.skin.bones[kMaxInfluences * v + k] == b) sum += of.skin.weights[kMaxInfluences * v + k];
        return sum;
      };
      ASSERT_NEAR(weight(actor), weight(truth), test::kFloatChain) << v << " " << b;
    }
  EXPECT_EQ(actor.labels, truth.labels);
  EXPECT_EQ(actor.texture.pixels, truth.texture.pixels);
  for (size_t i = 0; i < truth.colors.size(); ++i) ASSERT_NEAR(actor.colors[i], truth.colors[i], test::kTextUvColor);
  for (int keypoint : {kLeftEye, kRightEye, kNose, kChin, kNeck, kPelvis, kLeftWrist, kRightKnee, kLeftToe})
    EXPECT_LT((actor.keypoints[keypoint].rest_position_mm - truth.keypoints[keypoint].rest_position_mm - shift).norm(),
              test::kMillimetreFloat)
        << kKeypointNames[keypoint];
  EXPECT_FALSE(actor.guessed_weights);
  ASSERT_EQ(imported.notes.size(), 1u);  // of the spare and the doubled vertex
  EXPECT_NE(imported.notes[0].find("2 of "), std::string::npos);
}

// With labels guessed, most vertices have the material they have.
TEST_F(ImportTemplate, LabelsAreGuessedWithoutAFile) {
  TemplateFiles without = files();
  without.labels.clear();
  const ImportedTemplate imported = import_template(without, "template");
  ASSERT_EQ(imported.actor.labels.size(), source().model.labels.size());
  int same = 0;
  for (size_t i = 0; i < imported.actor.labels.size(); ++i)
    same += imported.actor.labels[i] == source().model.labels[i];
  EXPECT_GT(same, test::kGuessedLabels * static_cast<double>(imported.actor.labels.size()));
}

TEST_F(ImportTemplate, ColoursWithoutATexture) {
  TemplateFiles given = files();
  given.mesh = write("grey.obj", edited(source().obj(), "mtllib template.mtl\n", ""));
  const Actor grey = loaded(import_template(given, "grey"));
  EXPECT_TRUE(grey.texture.empty());
  EXPECT_EQ(grey.colors, std::vector<float>(grey.colors.size(), 0.5f));
  // --texture, for an .obj that names none.
  given.texture = folder_ / "template.png";
  EXPECT_EQ(loaded(import_template(given, "textured")).texture.pixels, source().model.texture.pixels);
  // Colours behind the coordinates: red at the first vertex of the template, sea green elsewhere.
  given.texture.clear();
  std::string text;
  std::istringstream lines(source().obj());
  int n = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("v ", 0) == 0) line += ++n == 2 ? " 1 0 0" : " 0.2 0.6 0.4";
    if (line.rfind("mtllib", 0) != 0) text += line + "\n";
  }
  given.mesh = write("colored.obj", text);
  const Actor colored_actor = loaded(import_template(given, "colored"));
  EXPECT_NEAR(colored_actor.colors[0], 1, test::kHandComputed);
  EXPECT_NEAR(colored_actor.colors[1], 0, test::kHandComputed);
  EXPECT_NEAR(colored_actor.colors[4], 0.6, test::kHandComputed);
}

// Bones with names of their own, and MPI-INF-3DHP's.
TEST_F(ImportTemplate, OtherNames) {
  TemplateFiles given = files();
  given.skeleton = write("own.skeleton", edited(source().skeleton(), "left_hand", "wrist_l"));
  given.skin = write("own.skin", edited(source().skin(), "left_hand", "wrist_l"));
  test::expect_refused<IoError>([&] { import_template(given, "own"); },
                                {"own.skeleton", "no bone found for left_wrist;", "--bones", "wrist_l"});
  given.bones = write("bones.json", R"({"left_wrist": "wrist_l"})");
  const ImportedTemplate own = import_template(given, "own");
  EXPECT_EQ(own.skeleton.skeleton.bones[own.rig[kRigLeftWrist]].name, "wrist_l");
  EXPECT_EQ(loaded(own).skeleton.n_dofs(), original().skeleton.n_dofs());
  given.bones = write("bones.json", R"({"left_wrist": "wrist_l_rx"})");  // a joint of it
  EXPECT_EQ(import_template(given, "own").rig[kRigLeftWrist], own.rig[kRigLeftWrist]);

  // Pelvis and chest are where legs and arms part, whatever they are called.
  given.skeleton = write("own.skeleton", edited(edited(source().skeleton(), "spine_1", "hub"), "spine_4", "yoke"));
  given.skin = write("own.skin", edited(edited(source().skin(), "spine_1", "hub"), "spine_4", "yoke"));
  given.bones.clear();
  const ImportedTemplate hub = import_template(given, "own");
  EXPECT_EQ(hub.skeleton.skeleton.bones[hub.rig[kRigRoot]].name, "hub");
  EXPECT_EQ(hub.skeleton.skeleton.bones[hub.rig[kRigChest]].name, "yoke");
  EXPECT_EQ(loaded(hub).skeleton.n_dofs(), original().skeleton.n_dofs());

  const std::pair<const char*, const char*> renamed[] = {
      {"_hand", "_wrist"}, {"left_ee", "left_hand"}, {"right_ee", "right_hand"}, {"spine_1", "pelvis"},
      {"neck_1", "neck"},  {"neck_2", "head"},       {"head_ee", "head_top"}};
  std::string skeleton = source().skeleton(), skin = source().skin();
  for (const auto& [from, to] : renamed) {
    skeleton = edited(skeleton, from, to);
    skin = edited(skin, from, to);
  }
  given.skeleton = write("other.skeleton", skeleton);
  given.skin = write("other.skin", skin);
  const ImportedTemplate other = import_template(given, "other");
  EXPECT_EQ(other.skeleton.skeleton.bones[other.rig[kRigLeftWrist]].name, "left_wrist");
  EXPECT_EQ(other.skeleton.skeleton.bones[other.rig[kRigRoot]].name, "pelvis");
  EXPECT_EQ(other.skeleton.skeleton.bones[other.rig[kRigChest]].name, "spine_4");
}

// What does not fit together, by one line each.
TEST_F(ImportTemplate, Refusals) {
  const auto refused = [&](auto&& change, const std::vector<std::string>& words) {
    TemplateFiles given = files();
    change(given);
    test::expect_refused<IoError>([&] { import_template(given, "bad"); }, words);
  };
  const std::string skin = source().skin();
  const size_t n = source().n_file_vertices();
  refused([&](auto& f) { f.skin = write("s.skin", skin.substr(0, skin.rfind("\n", skin.size() - 2) + 1)); },
          {format("s.skin: has weights of %zu vertices", n - 1), format("template.obj has %zu", n)});
  refused([&](auto& f) { f.skin = write("s.skin", edited(skin, " left_knee ", " left_wheel ")); },
          {"s.skin:3: ", "\"left_wheel\""});
  std::string metres;
  std::istringstream lines(source().obj());
  for (std::string line; std::getline(lines, line);) {
    double x, y, z;
    const bool vertex = std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3;
    metres += (vertex ? format("v %.6f %.6f %.6f", x / 1000, y / 1000, z / 1000) : line) + "\n";
  }
  refused([&](auto& f) { f.mesh = write("m.obj", metres); }, {"m.obj: reaches from", "zero angles, in mm"});
  refused(
      [&](auto& f) {
        test::SkeletoolTemplate small = source();
        for (test::SkeletoolJoint& joint : small.joints) joint.offset /= 1000;
        f.skeleton = write("m.skeleton", small.skeleton());
        f.mesh = write("m.obj", metres);
      },
      {"m.obj: is 1.7", "m.skeleton must be in mm"});
  refused([&](auto& f) { f.skeleton = write("s.skeleton", edited(source().skeleton(), "1.0\n", "1.5\n")); },
          {"s.skeleton:1: ", "does not begin"});
  refused(
      [&](auto& f) {
        std::string text = source().skeleton();
        const size_t at = text.find("1.0\n", text.find("left_elbow_rx"));
        f.skeleton = write("s.skeleton", text.replace(at, 3, "1.1"));
      },
      {"s.skeleton: joint \"left_elbow_rx\" is scaled"});
  refused([&](auto& f) { f.labels = write("l.txt", "5\n6\n"); },
          {"l.txt: has 2 labels", format("template.obj has %zu", n)});
  refused([&](auto& f) { f.bones = write("b.json", "[]"); }, {"b.json: is not a JSON object"});
  refused([&](auto& f) { f.bones = write("b.json", R"({"left_thumb": "root"})"); }, {"b.json: field \"left_thumb\""});
  refused([&](auto& f) { f.bones = write("b.json", R"({"left_wrist": "hoof"})"); }, {"b.json", "no bone \"hoof\""});
  refused([&](auto& f) { f.bones = write("b.json", R"({"left_elbow": "left_shoulder"})"); },
          {"template.skeleton: left_elbow and left_shoulder are both the bone \"left_shoulder\""});
  refused([&](auto& f) { f.texture = folder_ / "none.png"; }, {"none.png"});
}

TEST_F(ImportTemplate, LabelFiles) {
  const auto npy = [](const std::string& type, const std::string& shape, const std::string& data) {
    std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
    header.resize(117, ' ');
    header += '\n';
    return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + data;
  };
  const std::vector<uint8_t> expected = {5, 0, 19};
  EXPECT_EQ(read_vertex_labels(write("l.npy", npy("|u1", "(3,)", {5, 0, 19})), 3, "m.obj"), expected);
  EXPECT_EQ(read_vertex_labels(write("l.npy", npy("<i2", "(3,)", {5, 0, 0, 0, 19, 0})), 3, "m.obj"), expected);
  const float floats[3] = {5, 0, 19};
  EXPECT_EQ(read_vertex_labels(
                write("l.npy", npy("<f4", "(3,)", std::string(reinterpret_cast<const char*>(floats), sizeof(floats)))),
                3, "m.obj"),
            expected);
  EXPECT_EQ(read_vertex_labels(write("l.txt", "5\r\n0\n\n19"), 3, "m.obj"), expected);
  const auto refused = [&](const std::string& bytes, const std::vector<std::string>& words) {
    test::expect_refused<IoError>([&] { read_vertex_labels(write("bad.npy", bytes), 3, "m.obj"); }, words);
  };
  refused(npy("|u1", "(3,)", {5, 0}), {"bad.npy", "2 values", "says 3"});
  refused(npy("|u1", "(3, 1)", {5, 0, 19}), {"bad.npy", "its shape"});
  refused(npy("|O8", "(3,)", {5, 0, 19}), {"bad.npy", "type '|O8'"});
  refused(npy("|u1", "(3,)", {5, 0, 20}), {"label of vertex 2 is 20", "0..19"});
  refused(npy("|u1", "(3,)", {5, 0, 19}).substr(0, 60), {"ends in its header"});
  refused("5\n0.5\n19\n", {"label of vertex 1 is 0.5"});
  refused("5\npants\n19\n", {"bad.npy:2: "});
}

// Every joint and vertex of the truth is where the file's chain and skin, multiplied out by hand, have it.
TEST_F(ImportTemplate, TruthIsTheMotionInTheCamera) {
  const ImportedTemplate imported = import_template(files(), "template");
  const Actor actor = loaded(imported);
  std::vector<std::vector<double>> parameters;
  for (int frame = 0; frame < 3; ++frame) {
    parameters.emplace_back();
    for (size_t p = 0; p < source().dofs.size(); ++p)
      parameters.back().push_back(p < 3 ? 40.0 * frame * static_cast<double>(p + 1) : 0.5 * std::sin(p + 1.7 * frame));
  }
  MotionFiles motion;
  motion.motion = write("m.motion", source().motion({7, 8, 10}, parameters));
  // Level, 3.5 m in front of the person: the world's z is up in the picture.
  motion.cameras = write("c.calibration",
                         "Skeletool Camera Calibration File V1.0\n"
                         "name other\n size 64 48\n animated 0\n intrinsic 50 0 32 0 0 50 24 0 0 0 1 0 0 0 0 1\n"
                         " extrinsic 1 0 0 0 0 1 0 0 0 0 1 9000 0 0 0 1\n radial 0\n"
                         "name front\n size 640 480\n animated 0\n intrinsic 400 0 320 0 0 401 240 0 0 0 1 0 0 0 0 1\n"
                         " extrinsic 1 0 0 -200 0 0 -1 900 0 1 0 3500 0 0 0 1\n radial 0\n");
  motion.camera = "front";
  const TemplateMotion read = read_template_motion(motion, imported.skeleton);
  EXPECT_EQ(read.n_frames, 4);
  const TruthSummary summary = write_template_truth(imported, actor, read, folder_);
  EXPECT_EQ(summary.n_known, 3);
  EXPECT_EQ(summary.n_outside, 0);
  EXPECT_EQ(load_camera(folder_ / "camera.json").fy, 401);

  TruthFolder truth = open_truth(folder_, actor.n_vertices());
  EXPECT_EQ(truth.vertices->n_samples(), 4);
  const std::vector<std::string> captured = {
      "root",        "neck",     "left_shoulder", "left_elbow", "left_wrist", "right_shoulder", "right_elbow",
      "right_wrist", "left_hip", "left_knee",     "left_ankle", "right_hip",  "right_knee",     "right_ankle"};
  EXPECT_EQ(match_joints(captured, truth.joints.names).size(), captured.size());
  const Camera camera = load_camera(folder_ / "camera.json");
  const auto seen = [](const Vector3d& p) { return Vector3d(p.x() - 200, -p.z() + 900, p.y() + 3500); };
  int frame = 0;
  for (int index : {0, 1, 3}) {
    const TruthFrame row = truth_frame(truth, index, camera);
    ASSERT_TRUE(row.person);
    const auto chain = source().frames(source().joint_values(parameters[frame++]));
    for (int v = 0; v < actor.n_vertices(); ++v) {
      const Vector3d expected = seen(source().posed(v, chain));
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(row.vertices_mm[3 * v + k], expected[k], test::kMillimetreFloat) << v;
    }
    const std::pair<const char*, const char*> joints[] = {
        {"root", "spine_1"}, {"left_wrist", "left_hand"}, {"neck", "neck_1"}, {"right_knee", "right_knee"}};
    for (const auto& [name, bone] : joints) {
      const Vector3d expected = seen(chain[source().last_joint.at(bone)].translation());
      const int j = index_of(truth.joints.names, name);
      ASSERT_GE(j, 0);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(row.joints_mm[3 * j + k], expected[k], test::kMillimetreFloat) << name;
    }
  }
  EXPECT_FALSE(truth_frame(truth, 2, camera).person);  // the motion has no frame 9

  motion.first = 8;
  EXPECT_EQ(read_template_motion(motion, imported.skeleton).n_frames, 3);
  motion.first = 11;
  test::expect_refused<ConfigError>([&] { read_template_motion(motion, imported.skeleton); },
                                    {"--first 11", "m.motion has frames 7 to 10"});
  motion.first = -1;
  motion.camera = "back";
  test::expect_refused<ConfigError>([&] { read_template_motion(motion, imported.skeleton); },
                                    {"--camera back", "c.calibration", "other, front"});
  motion.camera.clear();
  test::expect_refused<ConfigError>([&] { read_template_motion(motion, imported.skeleton); }, {"--camera: name one"});
  motion.motion = write("m.motion", "Skeletool Motion File V1.0\n1 2 3\n");
  test::expect_refused<IoError>([&] { read_template_motion(motion, imported.skeleton); }, {"m.motion:2: 2 values for"});
}

}  // namespace
}  // namespace livecap::acquire
