#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "actor/actor.h"
#include "actor/bone_names.h"
#include "actor/glb_fixture.h"
#include "actor/inspect.h"
#include "base/text.h"
#include "livecap/error.h"
#include "support/data_dir.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::Fixture;
using test::FixtureOptions;
using test::make_fixture;

Eigen::Vector3d vertex(const Actor& actor, int v) {
  return Eigen::Map<const Eigen::Vector3f>(actor.mesh.positions.data() + 3 * v).cast<double>();
}

Eigen::Vector3d rest_joint(const Actor& actor, const char* bone) {
  const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
  return rest.camera_from_bone[actor.skeleton.bone_index(bone)].translation();
}

std::string message_of(const std::string& bytes) {
  try {
    load_actor_bytes(bytes, "broken.glb");
  } catch (const IoError& e) {
    return e.what();
  }
  return "";
}

bool has_note(const Actor& actor, const std::string& part) {
  for (const std::string& note : actor.notes) {
    if (note.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(LoadActor, WeldsSeamsInOrderOfFirstOccurrence) {
  const Fixture f = make_fixture();
  const Actor actor = load_actor_bytes(f.bytes, "fixture");
  ASSERT_EQ(actor.n_vertices(), static_cast<int>(f.welded_m.size()));
  for (int v = 0; v < actor.n_vertices(); ++v)
    EXPECT_LT((vertex(actor, v) - 1000 * f.welded_m[v]).norm(), test::kMillimetreFloat);
  ASSERT_EQ(static_cast<int>(actor.render.template_vertex.size()), f.n_file_vertices);
  EXPECT_EQ(actor.render.template_vertex[16], 12);  // the seam row repeats vertices 12..15
  EXPECT_EQ(actor.render.template_vertex[20], 16);
  EXPECT_FLOAT_EQ(actor.render.uvs[2 * 16 + 1], 0.9f);
  EXPECT_EQ(actor.mesh.n_triangles(), 18 * 20);  // the degenerate one of each patch is gone
  EXPECT_EQ(actor.render.triangles.size(), actor.mesh.triangles.size());
  for (size_t i = 0; i < actor.mesh.triangles.size(); ++i)
    EXPECT_EQ(actor.mesh.triangles[i], actor.render.template_vertex[actor.render.triangles[i]]);
  EXPECT_EQ(actor.labels[16], 1);
  EXPECT_EQ(actor.rigidity[16], 100.f);
}

// The lower left quarter of the picture, turned by a quarter: what the extension's own text has as its example.
TEST(LoadActor, MovesTextureCoordinatesAsTheMaterialSays) {
  Fixture f = make_fixture();
  f.document["extensionsUsed"] = f.document["extensionsRequired"] = {"KHR_texture_transform"};
  f.document["materials"] = {{{"pbrMetallicRoughness",
                               {{"baseColorTexture",
                                 {{"index", 0},
                                  {"texCoord", 1},
                                  {"extensions",
                                   {{"KHR_texture_transform",
                                     {{"offset", {0, 1}},
                                      {"rotation", std::numbers::pi / 2},
                                      {"scale", {0.5, 0.25}},
                                      {"texCoord", 0}}}}}}}}}}};
  f.document["meshes"][0]["primitives"][0]["material"] = 0;
  const Actor plain = load_actor_bytes(make_fixture().bytes, "fixture");
  const Actor moved = load_actor_bytes(Fixture::pack(f.document, f.bin), "fixture");
  ASSERT_EQ(moved.render.uvs.size(), plain.render.uvs.size());
  for (size_t i = 0; i < plain.render.uvs.size(); i += 2) {
    EXPECT_NEAR(moved.render.uvs[i], 0.25 * plain.render.uvs[i + 1], test::kHandComputed);
    EXPECT_NEAR(moved.render.uvs[i + 1], 1 - 0.5 * plain.render.uvs[i], test::kHandComputed);
  }
  auto& transform = f.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"];
  transform["KHR_texture_transform"]["scale"] = {1};
  EXPECT_NE(message_of(Fixture::pack(f.document, f.bin)).find("KHR_texture_transform.scale is not two numbers"),
            std::string::npos);
}

TEST(LoadActor, RestPoseReproducesTheBindJointsExactly) {
  const Actor actor = load_actor_bytes(make_fixture().bytes, "fixture");
  ASSERT_EQ(actor.skeleton.n_dofs(), 32);
  const std::pair<const char*, Eigen::Vector3d> expected[] = {
      {"root", {0, 980, 10}},           {"neck", {0, 1500, 0}},
      {"left_clavicle", {50, 1450, 0}}, {"left_shoulder", {180, 1440, -10}},
      {"left_elbow", {420, 1300, -30}}, {"right_elbow", {-430, 1310, -20}},
      {"left_knee", {130, 510, 30}},    {"right_knee", {-120, 500, 20}},
      {"left_ankle", {160, 90, -10}}};
  for (const auto& [bone, position] : expected)
    EXPECT_LT((rest_joint(actor, bone) - position).norm(), test::kMillimetreFloat) << bone;
}

// The stored rest angles, taken back to zero, must straighten the limbs into the T-pose.
TEST(LoadActor, ZeroAnglesAreATPose) {
  const Actor actor = load_actor_bytes(make_fixture().bytes, "fixture");
  Pose zero = rest_pose(actor.skeleton);
  zero.angles_rad.setZero();
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, zero);
  auto joint = [&](const char* name) { return posed.camera_from_bone[actor.skeleton.bone_index(name)].translation(); };
  EXPECT_LT(((joint("left_elbow") - joint("left_shoulder")).normalized() - Eigen::Vector3d::UnitX()).norm(),
            test::kDirectionFloat);
  EXPECT_LT(((joint("right_elbow") - joint("right_shoulder")).normalized() + Eigen::Vector3d::UnitX()).norm(),
            test::kDirectionFloat);
  EXPECT_LT(((joint("left_knee") - joint("left_hip")).normalized() + Eigen::Vector3d::UnitY()).norm(),
            test::kDirectionFloat);
  EXPECT_LT(((joint("right_knee") - joint("right_hip")).normalized() + Eigen::Vector3d::UnitY()).norm(),
            test::kDirectionFloat);
  // The bent forearm comes into the plane of its hinge: no sideways (Z) part can be left that the hinge could remove.
  const auto wrist =
      posed.camera_from_rest[actor.skeleton.bone_index("left_elbow")] * actor.keypoints[kLeftWrist].rest_position_mm;
  EXPECT_NEAR((wrist - joint("left_elbow")).z(), 0, test::kMillimetreFloat);
}

TEST(LoadActor, ArmatureScaleAndRotationBecomeMetresYUp) {
  const Actor plain = load_actor_bytes(make_fixture().bytes, "fixture");
  FixtureOptions options;  // Mixamo through FBX: centimetres, Z up below the armature
  options.armature.topLeftCorner<3, 3>() =
      0.01 * Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Actor scaled = load_actor_bytes(make_fixture(options).bytes, "fixture");
  ASSERT_EQ(plain.n_vertices(), scaled.n_vertices());
  for (int v = 0; v < plain.n_vertices(); ++v)
    EXPECT_LT((vertex(plain, v) - vertex(scaled, v)).norm(), test::kMillimetreFloat);
  EXPECT_LT((rest_joint(scaled, "left_elbow") - Eigen::Vector3d(420, 1300, -30)).norm(), test::kMillimetreFloat);
}

TEST(LoadActor, TurnsASubjectThatFacesElsewhereAndSaysSo) {
  FixtureOptions options;
  options.armature.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (auto& joint : options.joints) joint.position_m = options.armature.topLeftCorner<3, 3>() * joint.position_m;
  const Actor actor = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_LT((rest_joint(actor, "left_elbow") - Eigen::Vector3d(420, 1300, -30)).norm(), test::kMillimetreFloat);
  EXPECT_TRUE(has_note(actor, "facing"));
}

TEST(LoadActor, HeightScalesMeshAndSkeletonTogether) {
  const Actor plain = load_actor_bytes(make_fixture().bytes, "fixture");
  const Actor tall = load_actor_bytes(make_fixture().bytes, "fixture", 2000);
  double low = 1e9, high = -1e9;
  for (int v = 0; v < tall.n_vertices(); ++v) {
    low = std::min(low, vertex(tall, v).y());
    high = std::max(high, vertex(tall, v).y());
  }
  EXPECT_NEAR(high - low, 2000, test::kMillimetreFloat);
  const double factor = (vertex(tall, 5) - vertex(tall, 100)).norm() / (vertex(plain, 5) - vertex(plain, 100)).norm();
  EXPECT_LT((rest_joint(tall, "left_knee") - factor * rest_joint(plain, "left_knee")).norm(), test::kMillimetreFloat);
  EXPECT_LT((tall.keypoints[kLeftHand].rest_position_mm - factor * plain.keypoints[kLeftHand].rest_position_mm).norm(),
            test::kMillimetreFloat);
}

TEST(LoadActor, FoldsUnmappedBonesIntoTheirAncestors) {
  const Fixture f = make_fixture();
  const Actor actor = load_actor_bytes(f.bytes, "fixture");
  const auto patch = [&](int joint) { return 16 * joint; };
  auto weight = [&](int v, const char* bone) {
    float sum = 0;
    for (int k = 0; k < kMaxInfluences; ++k) {
      if (actor.skin.bones[4 * v + k] == actor.skeleton.bone_index(bone)) sum += actor.skin.weights[4 * v + k];
    }
    return sum;
  };
  EXPECT_FLOAT_EQ(weight(patch(1), "chest"), .75f);  // spine 0.75, hips 0.25
  EXPECT_FLOAT_EQ(weight(patch(1), "root"), .25f);
  EXPECT_FLOAT_EQ(weight(patch(3), "neck"), 1.f);         // head, neck
  EXPECT_FLOAT_EQ(weight(patch(8), "left_elbow"), 1.f);   // knuckle, hand
  EXPECT_FLOAT_EQ(weight(patch(6), "left_elbow"), .75f);  // forearm 0.75, arm 0.25
  EXPECT_FLOAT_EQ(weight(patch(6), "left_shoulder"), .25f);
  EXPECT_FLOAT_EQ(weight(patch(16), "left_ankle"), 1.f);  // toe, foot
}

// Else the arms would turn and the skin of the chest stay behind.
TEST(LoadActor, ATrunkOfOneBoneDoesNotBend) {
  FixtureOptions options;
  for (auto& joint : options.joints) {
    if (std::string(joint.name) == "mixamorig:Spine") joint.name = "Wirbel";
    if (joint.parent && std::string(joint.parent) == "mixamorig:Spine") joint.parent = "Wirbel";
  }
  const Actor actor = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_EQ(actor.skeleton.n_dofs(), 29);
  EXPECT_TRUE(has_note(actor, "chest: no bone with skin"));
  for (const int bone : actor.skin.bones) EXPECT_NE(bone, actor.skeleton.bone_index("chest"));
  options.livecap = {{"bones", {{"chest", "Wirbel"}}}};
  EXPECT_EQ(load_actor_bytes(make_fixture(options).bytes, "fixture").skeleton.n_dofs(), 32);
}

TEST(LoadActor, TheHighestBoneOfTheSpineIsTheChest) {
  std::vector<std::string> notes;
  const auto chest = [&](const std::vector<std::string>& names) {
    const int found = match_rig(names, {}, notes).index[kRigChest];
    return found < 0 ? "" : names[found];
  };
  EXPECT_EQ(chest({"Hips", "Spine", "Spine1", "Spine2", "Neck"}), "Spine2");
  EXPECT_EQ(chest({"Hips", "Spine", "Spine1", "Neck"}), "Spine1");
  EXPECT_EQ(chest({"Hips", "Spine", "Neck"}), "Spine");
  EXPECT_EQ(chest({"pelvis", "spine_01", "spine_02", "spine_03", "neck_01"}), "spine_03");
  EXPECT_EQ(chest({"pelvis", "spine_01", "neck_01"}), "spine_01");
  EXPECT_EQ(chest({"root", "chest", "neck"}), "chest");
  EXPECT_EQ(chest({"Hips", "Neck"}), "");
}

TEST(LoadActor, SkeletonsOfSkeletool) {
  std::vector<std::string> notes;
  const auto expect = [&](std::vector<std::string> names, std::map<int, std::string> joints) {
    for (const char* side : {"left_", "right_"})
      for (const char* bone : {"clavicle", "shoulder", "elbow", "hip", "knee", "ankle"})
        names.push_back(std::string(side) + bone);
    const RigMatch match = match_rig(names, {}, notes);
    EXPECT_EQ(match.table, "Skeletool");
    for (int joint = 0; joint < kRigJointCount; ++joint) {
      const bool required = rig_joint_required(joint) || joint == kRigLeftClavicle || joint == kRigRightClavicle;
      const std::string expected = joints.count(joint) ? joints[joint]
                                   : required          ? std::string(kRigJointNames[joint])
                                                       : "";
      EXPECT_EQ(match.index[joint] < 0 ? "" : names[match.index[joint]], expected) << kRigJointNames[joint];
    }
  };
  // DeepCap's.
  expect({"root", "spine_3", "spine_4", "neck_1", "head_ee", "left_lowarm", "left_hand", "left_ee", "right_lowarm",
          "right_hand", "right_ee", "spine_2", "spine_1", "left_toes", "left_foot", "right_toes", "right_foot"},
         {{kRigRoot, "spine_1"},
          {kRigChest, "spine_4"},
          {kRigNeck, "neck_1"},
          {kRigHeadTop, "head_ee"},
          {kRigLeftWrist, "left_hand"},
          {kRigRightWrist, "right_hand"},
          {kRigLeftToe, "left_toes"},
          {kRigRightToe, "right_toes"}});
  // MPI-INF-3DHP's.
  expect({"spine3", "spine4", "spine2", "spine", "pelvis", "neck", "head", "head_top", "left_wrist", "left_hand",
          "right_wrist", "right_hand", "left_foot", "left_toe", "right_foot", "right_toe"},
         {{kRigRoot, "pelvis"},
          {kRigChest, "spine4"},
          {kRigHead, "head"},
          {kRigHeadTop, "head_top"},
          {kRigLeftToe, "left_foot"},
          {kRigRightToe, "right_foot"}});
}

TEST(LoadActor, ReadsUnrealNamesAndFillsAbsentClavicles) {
  FixtureOptions options;
  options.joints.clear();
  const std::map<std::string, const char*> unreal = {
      {"Hips", "pelvis"},      {"Spine", "spine_01"},      {"Neck", "neck_01"},
      {"Head", "head"},        {"LeftArm", "upperarm_l"},  {"LeftForeArm", "lowerarm_l"},
      {"LeftHand", "hand_l"},  {"RightArm", "upperarm_r"}, {"RightForeArm", "lowerarm_r"},
      {"RightHand", "hand_r"}, {"LeftUpLeg", "thigh_l"},   {"LeftLeg", "calf_l"},
      {"LeftFoot", "foot_l"},  {"LeftToeBase", "ball_l"},  {"RightUpLeg", "thigh_r"},
      {"RightLeg", "calf_r"},  {"RightFoot", "foot_r"},    {"LeftHandMiddle1", "middle_01_l"}};
  for (test::FixtureJoint joint : test::mixamo_joints()) {
    auto rename = [&](const char* name) -> const char* {
      if (!name) return nullptr;
      const auto found = unreal.find(std::string(name).substr(10));
      return found == unreal.end() ? "spine_01" : found->second;  // children of the clavicles hang on the spine
    };
    if (std::string(joint.name).find("Shoulder") != std::string::npos) continue;
    options.joints.push_back({rename(joint.name), rename(joint.parent), joint.position_m});
  }
  const Actor actor = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_TRUE(has_note(actor, "UE/MakeHuman"));
  EXPECT_TRUE(has_note(actor, "left_clavicle: no bone"));
  EXPECT_LT((rest_joint(actor, "left_shoulder") - Eigen::Vector3d(180, 1440, -10)).norm(), test::kMillimetreFloat);
  EXPECT_GT(rest_joint(actor, "left_clavicle").x(), 0);
}

TEST(LoadActor, ExtrasNameBonesLimitsMarkersAndOffsets) {
  FixtureOptions options;
  for (auto& joint : options.joints) {
    if (std::string(joint.name) == "mixamorig:Neck") joint.name = "Hals";
    if (joint.parent && std::string(joint.parent) == "mixamorig:Neck") joint.parent = "Hals";
  }
  EXPECT_NE(message_of(make_fixture(options).bytes).find("no bone found for neck"), std::string::npos);
  options.livecap = {{"bones", {{"neck", "Hals"}}},
                     {"limits", {{"left_elbow_y", {-100, 0}}}},
                     {"markers", {{"nose", 50}}},
                     {"keypoints", {{"left_ankle", {0.01, 0, 0}}}}};
  const Actor actor = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_LT((actor.keypoints[kNose].rest_position_mm - vertex(actor, 50)).norm(), test::kMillimetreFloat);
  EXPECT_LT((actor.keypoints[kLeftAnkle].rest_position_mm - Eigen::Vector3d(170, 90, -10)).norm(),
            test::kMillimetreFloat);
  for (const Dof& dof : actor.skeleton.dofs) {
    if (dof.name == "left_elbow_y") EXPECT_NEAR(dof.min_rad, -100 * std::numbers::pi / 180, test::kDoubleExact);
  }
}

// What a field of the extras says of an actor, and the line of inspect_actor() that repeats it.
void expect_told(const char* field, const char* value, bool Actor::*told, const std::string& line) {
  FixtureOptions options;
  const Actor plain = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_FALSE(plain.*told);
  EXPECT_EQ(inspect_actor(plain).find(std::string(value) + "\n"), std::string::npos);
  options.livecap = {{field, value}};
  const Actor actor = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_TRUE(actor.*told);
  EXPECT_EQ(actor.guessed_weights + actor.rough_shape, 1) << "and nothing else";
  EXPECT_NE(inspect_actor(actor).find(line + "\n"), std::string::npos);
}

TEST(LoadActor, ExtrasTellThatWeightsAreGuessed) {
  expect_told("weights", "guessed", &Actor::guessed_weights, "weights     guessed");
}

TEST(LoadActor, ExtrasTellThatTheShapeIsRough) {
  expect_told("shape", "rough", &Actor::rough_shape, "shape       rough");
}

TEST(LoadActor, ARestAngleOutsideItsLimitsWidensThemWithANote) {
  FixtureOptions options;
  options.livecap = {{"limits", {{"left_shoulder_z", {0, 90}}}}};
  const Actor actor = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_TRUE(has_note(actor, "left_shoulder_z: rest angle"));
  for (const Dof& dof : actor.skeleton.dofs)
    EXPECT_TRUE(dof.min_rad <= dof.rest_rad && dof.rest_rad <= dof.max_rad) << dof.name;
}

TEST(LoadActor, DefaultsAreSaid) {
  FixtureOptions options;
  options.labels = false;
  const Actor actor = load_actor_bytes(make_fixture(options).bytes, "fixture");
  EXPECT_TRUE(has_note(actor, "without _LABEL"));
  EXPECT_TRUE(has_note(actor, "grey"));
  EXPECT_TRUE(has_note(actor, "connected components"));
  EXPECT_EQ(actor.labels[16 * 15], 18);  // foot -> left shoe
  EXPECT_EQ(actor.colors[0], 0.5f);
  const std::string report = inspect_actor(actor);
  for (const char* part : {"320 vertices", "left_shoulder_z", "left-shoe", "nose", "grey"})
    EXPECT_NE(report.find(part), std::string::npos) << part;
}

TEST(LoadActor, BrokenFilesNameTheFileAndTheField) {
  const Fixture good = make_fixture();
  auto edited = [&](auto&& edit) {
    nlohmann::json document = good.document;
    edit(document);
    return message_of(Fixture::pack(document, good.bin));
  };
  EXPECT_NE(message_of("").find("broken.glb: not a GLB"), std::string::npos);
  EXPECT_NE(message_of(good.bytes.substr(0, good.bytes.size() / 2)).find("truncated"), std::string::npos);
  EXPECT_NE(edited([](auto& d) {
              d.erase("skins");
              d["nodes"].back().erase("skin");
            }).find("no skin"),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) { d["accessors"][0]["count"] = 1000000; }).find("beyond"), std::string::npos);
  EXPECT_NE(edited([](auto& d) { d["bufferViews"][0]["byteLength"] = 100000000; }).find("bufferViews[0]"),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) { d["bufferViews"][0]["byteOffset"] = 4294967295u; }).find("bufferViews[0]"),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) { d["nodes"][0]["children"] = {d["nodes"].size() - 2}; }).size(),
            0u);  // a cycle or two parents
  EXPECT_NE(edited([](auto& d) { d["skins"][0]["joints"][3] = 9999; }).find("skins[0].joints"), std::string::npos);
  EXPECT_NE(edited([](auto& d) { d["meshes"][0]["primitives"][0]["indices"] = 77; }).find("indices"),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) {
              for (auto& n : d["nodes"]) n["name"] = "bone";
            }).find("known name"),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }).find("KHR_draco"),
            std::string::npos);
  EXPECT_NE(
      edited([](auto& d) { d["meshes"][0]["extras"]["livecap"]["markers"]["nose"] = 40000; }).find("markers.nose"),
      std::string::npos);
  EXPECT_NE(edited([](auto& d) {
              d["meshes"][0]["extras"]["livecap"]["weights"] = {"a", 1};
            }).find("weights is [\"a\",1], must be \"guessed\""),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) {
              d["meshes"][0]["extras"]["livecap"]["shape"] = "exact";
            }).find("shape is \"exact\", must be \"rough\""),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) {
              d["meshes"][0]["extras"]["livecap"]["keypoints"]["nose"] = {1e300, 0, 0};
            }).find("keypoints.nose is [1e+300,0,0], must be [x, y, z], metres"),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) {
              d["meshes"][0]["extras"]["livecap"]["limits"]["left_elbow_y"] = {5, "six"};
            }).find("limits.left_elbow_y is [5,\"six\"], must be [min, max], degrees"),
            std::string::npos);
  EXPECT_NE(edited([](auto& d) {  // at most 1e19 a node, but one behind the other
              for (auto& n : d["nodes"])
                if (!n.contains("mesh")) n["matrix"] = {1e19, 0, 0, 0, 0, 1e19, 0, 0, 0, 0, 1e19, 0, 0, 0, 0, 1};
            })
                .find("must be within 10 km"),
            std::string::npos);
  FixtureOptions few;
  few.joints.resize(8);
  EXPECT_NE(message_of(make_fixture(few).bytes).find("no bone found for"), std::string::npos);
  const std::string bomb = "{\"extras\":" + std::string(200000, '[') + std::string(200000, ']') + "}";
  EXPECT_NE(message_of(Fixture::pack_text(bomb, "")).find("nested deeper"), std::string::npos);
}

TEST(LoadActor, NotesAndMessagesAreLinesForATerminal) {
  FixtureOptions options;
  options.livecap = {{"limits", {{"a\xc2\x9bz", {0, 1}}}}};
  const std::vector<std::string> notes = load_actor_bytes(make_fixture(options).bytes, "test.glb").notes;
  EXPECT_EQ(std::count(notes.begin(), notes.end(), "extras.livecap.limits: there is no joint angle \"a?z\"; ignored"),
            1);
  std::string letters;
  for (int i = 0; i < 30; ++i) letters += "\xc3\xa9";
  options.livecap = {{"markers", {{"nose", letters}}}};
  EXPECT_EQ(message_of(make_fixture(options).bytes), "broken.glb: extras.livecap.markers.nose is \"" +
                                                         letters.substr(0, 38) + ", must be the index of a vertex");
}

// Whatever the bytes are, loading ends with an actor or an IoError.
TEST(LoadActor, SurvivesMutatedBytes) {
  const Fixture good = make_fixture();
  std::mt19937 rng(2024);
  const size_t json_end = 20 + good.document.dump().size();
  int n_loaded = 0, n_refused = 0;
  for (int trial = 0; trial < 1200; ++trial) {
    std::string bytes = good.bytes;
    const int n_changes = 1 + static_cast<int>(rng() % 4);
    for (int k = 0; k < n_changes; ++k) {
      const size_t at = rng() % (trial % 3 == 0 ? bytes.size() : json_end);
      // Digits stay digits half of the time, so that numbers change without breaking the JSON.
      if (bytes[at] >= '0' && bytes[at] <= '9' && rng() % 2)
        bytes[at] = static_cast<char>('0' + rng() % 10);
      else
        bytes[at] = static_cast<char>(rng());
    }
    if (trial % 10 == 0) bytes.resize(rng() % bytes.size());
    try {
      const Actor actor = load_actor_bytes(bytes, "mutant");
      for (float x : actor.mesh.positions) ASSERT_TRUE(std::isfinite(x));
      for (int32_t i : actor.mesh.triangles) ASSERT_TRUE(i >= 0 && i < actor.n_vertices());
      for (int32_t b : actor.skin.bones) ASSERT_TRUE(b >= 0 && b < actor.skeleton.n_bones());
      ++n_loaded;
    } catch (const IoError&) {
      ++n_refused;
    }
  }
  EXPECT_GT(n_loaded, 100);
  EXPECT_GT(n_refused, 100);
}

TEST(LoadActor, ForeignActorAgreesWithItsTruth) {
  LIVECAP_DATA_OR_SKIP(path, "skirt_dance");
  const Actor actor = load_actor(path / "actor.glb");
  EXPECT_EQ(actor.n_vertices(), 5003);
  EXPECT_EQ(actor.render.template_vertex.size(), 6634u);
  EXPECT_EQ(connected_components(actor.n_vertices(), actor.mesh.triangles), 1);

  // The face is rigid: its vertices in a truth frame must be a rotation of the template, at the same size. A wrong
  // vertex order, scale or handedness cannot pass this.
  std::ifstream pc2(path / "truth/vertices.pc2", std::ios::binary);
  const int frame = 80;
  std::vector<float> truth(3 * actor.n_vertices());
  pc2.seekg(32 + std::streamoff{frame} * static_cast<std::streamoff>(truth.size()) * 4);
  pc2.read(reinterpret_cast<char*>(truth.data()), static_cast<std::streamsize>(truth.size() * 4));
  ASSERT_TRUE(pc2);
  std::vector<int> face;
  for (int v = 0; v < actor.n_vertices(); ++v) {
    if (actor.labels[v] == 13 && vertex(actor, v).y() > actor.keypoints[kNose].rest_position_mm.y()) face.push_back(v);
  }
  ASSERT_GT(face.size(), 100u);
  Eigen::Matrix3Xd rest(3, face.size()), seen(3, face.size());
  for (size_t i = 0; i < face.size(); ++i) {
    rest.col(i) = vertex(actor, face[i]);
    seen.col(i) = 1000 * Eigen::Map<const Eigen::Vector3f>(truth.data() + 3 * face[i]).cast<double>();
  }
  const Eigen::Vector3d rest_mean = rest.rowwise().mean(), seen_mean = seen.rowwise().mean();
  const Eigen::Matrix3d covariance = (seen.colwise() - seen_mean) * (rest.colwise() - rest_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  EXPECT_GT(rotation.determinant(), 0);
  const Eigen::Matrix3Xd error = (seen.colwise() - seen_mean) - rotation * (rest.colwise() - rest_mean);
  EXPECT_LT(error.colwise().norm().maxCoeff(), test::kRigidFaceMm);

  // The striped top and the tartan skirt: colours must vary and not be grey.
  double spread = 0;
  for (int v = 0; v < actor.n_vertices(); ++v)
    spread = std::max<double>(spread, std::abs(actor.colors[3 * v] - actor.colors[3 * v + 2]));
  EXPECT_GT(spread, 0.2);
}

}  // namespace
}  // namespace livecap
