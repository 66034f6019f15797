// What a receiver of the Virtual Motion Capture protocol reads, byte by byte, and whether its avatar stands as the
// person does.
#include "export/vmc.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <map>
#include <random>

#include "export/motion_fixture.h"
#include "geometry/shortest_turn.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A reader of OSC 1.0 of its own.
struct Reader {
  const std::vector<uint8_t>& bytes;
  size_t at = 0;

  uint32_t word() {
    EXPECT_LE(at + 4, bytes.size());
    uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = 256 * value + bytes[at++];
    return value;
  }
  float number() {
    const uint32_t value = word();
    float result;
    std::memcpy(&result, &value, 4);
    return result;
  }
  std::string text() {
    std::string result(reinterpret_cast<const char*>(&bytes[at]));
    const size_t end = at + (result.size() / 4 + 1) * 4;
    EXPECT_LE(end, bytes.size());
    for (size_t i = at + result.size(); i < end; ++i) EXPECT_EQ(bytes[i], 0);
    at = end;
    return result;
  }
};

struct Transform {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
};

struct Heard {
  int ok = -1;
  double time = -1;
  std::map<std::string, Transform> bones;
  std::optional<Transform> root;
};

Heard hear(const std::vector<uint8_t>& packet) {
  Heard heard;
  Reader reader{packet};
  EXPECT_EQ(reader.text(), "#bundle");
  EXPECT_EQ(reader.word(), 0u);
  EXPECT_EQ(reader.word(), 1u);
  while (reader.at < packet.size()) {
    const size_t size = reader.word(), end = reader.at + size;
    EXPECT_EQ(size % 4, 0u);
    const std::string address = reader.text(), types = reader.text();
    if (address == "/VMC/Ext/OK") {
      EXPECT_EQ(types, ",i");
      heard.ok = static_cast<int>(reader.word());
    } else if (address == "/VMC/Ext/T") {
      EXPECT_EQ(types, ",f");
      heard.time = reader.number();
    } else {
      EXPECT_EQ(types, ",sfffffff");
      const std::string name = reader.text();
      double v[7];
      for (double& x : v) x = reader.number();
      const Transform read{{v[0], v[1], v[2]}, {v[6], v[3], v[4], v[5]}};
      EXPECT_NEAR(read.rotation.norm(), 1, test::kFloatChain);
      if (address == "/VMC/Ext/Root/Pos") {
        EXPECT_EQ(name, "root");
        heard.root = read;
      } else {
        EXPECT_EQ(address, "/VMC/Ext/Bone/Pos");
        EXPECT_TRUE(heard.bones.emplace(name, read).second) << name << " twice";
      }
    }
    EXPECT_EQ(reader.at, end) << address;
    reader.at = end;
  }
  return heard;
}

LiveActor trunk_and_arm() {
  LiveActor actor;
  actor.bones = {{"root", -1, {}},
                 {"chest", 0, {0, 0.3f, -0.01f}},
                 {"neck", 1, {0.01f, 0.2f, -0.02f}},
                 {"left_clavicle", 1, {0.02f, 0.1f, 0.02f}},
                 {"left_shoulder", 3, {0.13f, 0.02f, -0.01f}},
                 {"left_elbow", 4, {0.27f, 0, 0}},
                 {"tail", 0, {0, -0.1f, -0.1f}}};
  return actor;
}

// A person with random rotations, and where that puts each bone.
LiveResult somebody(const LiveActor& actor, unsigned seed, std::array<float, 3> hips) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal;
  LiveResult result;
  result.report.status = TrackStatus::kOk;
  result.report.pts_ms = 1500;
  std::vector<Eigen::Isometry3f> bones;
  for (const LiveBone& bone : actor.bones) {
    const Eigen::Quaternionf q = Eigen::Quaternionf(normal(rng), normal(rng), normal(rng), normal(rng)).normalized();
    const Eigen::Translation3f place(bone.parent < 0 ? Eigen::Vector3f(hips[0], hips[1], hips[2])
                                                     : Eigen::Vector3f(Eigen::Vector3f::Map(bone.offset_m.data())));
    bones.push_back(bone.parent < 0 ? place * q : bones[bone.parent] * (place * q));
    const Eigen::Vector3f at = bones.back().translation();
    result.bones.push_back({{at.x(), at.y(), at.z()}, {q.x(), q.y(), q.z(), q.w()}});
  }
  result.vertices_m = {hips[0], hips[1] - 0.9f, hips[2], hips[0], hips[1] + 0.8f, hips[2]};
  return result;
}

// Unity's world: every vector with x mirrored. Chained as Unity chains its transforms.
TEST(Vmc, TheAvatarStandsAsThePersonDoes) {
  const LiveActor actor = trunk_and_arm();
  VmcEncoder encoder(actor, std::nullopt);
  const std::array<float, 3> first = {0.3f, -0.2f, -3};
  for (unsigned seed = 1; seed < 6; ++seed) {
    const std::array<float, 3> hips = {first[0] + 0.1f * float(seed - 1), first[1], first[2] + 0.2f * float(seed - 1)};
    const LiveResult person = somebody(actor, seed, hips);
    const Heard heard = hear(encoder.packet(person));
    EXPECT_EQ(heard.ok, 1);
    EXPECT_NEAR(heard.time, 1.5, test::kHandComputed);
    ASSERT_EQ(heard.bones.size(), 8u) << "the tail has no name";
    ASSERT_TRUE(heard.root);
    EXPECT_EQ(heard.root->position.norm(), 0);

    // With and without an upper chest, which avatars need not have.
    Eigen::Isometry3d world;
    for (const bool upper_chest : {false, true}) {
      const auto from = [&](const Eigen::Isometry3d& parent, const char* name) {
        const Transform& local = heard.bones.at(name);
        return Eigen::Isometry3d(parent * Eigen::Translation3d(local.position) * local.rotation);
      };
      // The lowest point of the first person is on y = 0, below it the middle.
      const auto expect_at = [&](const Eigen::Isometry3d& bone, int index) {
        const auto& p = person.bones[index].position_m;
        const Eigen::Vector3d expected(-(p[0] - first[0]), p[1] - (first[1] - 0.9), p[2] - first[2]);
        EXPECT_LT((bone.translation() - expected).norm(), test::kFloatChain) << actor.bones[index].name << " " << seed;
      };
      world = from(Eigen::Isometry3d::Identity(), "Hips");
      expect_at(world, 0);
      world = from(from(world, "Spine"), "Chest");
      if (upper_chest) world = from(world, "UpperChest");
      expect_at(from(world, "Neck"), 2);
      int index = 3;
      for (const char* name : {"LeftShoulder", "LeftUpperArm", "LeftLowerArm"})
        expect_at(world = from(world, name), index++);
    }
    // A direction of the forearm's own, both ways.
    Eigen::Quaternionf chain = Eigen::Quaternionf::Identity();
    for (const int i : {0, 1, 3, 4, 5}) {
      const auto& q = person.bones[i].rotation;
      chain = chain * Eigen::Quaternionf(q[3], q[0], q[1], q[2]);
    }
    const Eigen::Vector3f direction(0.3f, -0.5f, 0.8f);
    const Eigen::Vector3f turned = chain * direction;
    const Eigen::Vector3d seen = world.linear() * Eigen::Vector3d(-0.3, -0.5, 0.8);
    EXPECT_LT((seen - Eigen::Vector3d(-turned.x(), turned.y(), turned.z())).norm(), test::kFloatChain) << seed;
  }
}

// A camera that looks down by 20 degrees from 1.5 m: who stands upright on the floor does so in the avatar's world.
TEST(Vmc, AKnownFloorIsLevel) {
  const LiveActor actor = trunk_and_arm();
  const double pitch = 20 * M_PI / 180;
  FloorPlane floor;
  floor.normal = {0, -std::cos(pitch), -std::sin(pitch)};  // x right, y down, z forward
  floor.distance_mm = 1500;
  VmcEncoder encoder(actor, floor);

  LiveResult person = somebody(actor, 3, {0, 0, 0});
  // Hips 0.9 m above the floor's point 3 m in front of the camera's foot, upright: in glTF axes, y up, z backwards.
  const Eigen::Vector3d up(0, std::cos(pitch), std::sin(pitch)), ahead(0, std::sin(pitch), -std::cos(pitch));
  const Eigen::Vector3d hips = 3 * ahead + (0.9 - 1.5) * up;
  person.bones[0].position_m = {float(hips.x()), float(hips.y()), float(hips.z())};
  const Eigen::Quaternionf upright = shortest_turn(Eigen::Vector3d::UnitY(), up).cast<float>();
  person.bones[0].rotation = {upright.x(), upright.y(), upright.z(), upright.w()};

  const Transform sent = hear(encoder.packet(person)).bones.at("Hips");
  EXPECT_LT((sent.position - Eigen::Vector3d(0, 0.9, 0)).norm(), test::kFloatChain);
  EXPECT_LT(sent.rotation.angularDistance(Eigen::Quaterniond::Identity()), test::kFloatTurn);
}

TEST(Vmc, NobodyIsToldOfWithoutAPose) {
  const LiveActor actor = trunk_and_arm();
  VmcEncoder encoder(actor, std::nullopt);
  LiveResult nobody;
  nobody.report.status = TrackStatus::kNobody;
  nobody.report.pts_ms = 40;
  const Heard heard = hear(encoder.packet(nobody));
  EXPECT_EQ(heard.ok, 0);
  EXPECT_NEAR(heard.time, 0.04, test::kHandComputed);
  EXPECT_TRUE(heard.bones.empty());
}

// Every bone of LiveCap-32 has its name.
TEST(Vmc, NamesOfBones) {
  const std::map<std::string, std::string> limbs = {{"clavicle", "Shoulder"}, {"shoulder", "UpperArm"},
                                                    {"elbow", "LowerArm"},    {"hip", "UpperLeg"},
                                                    {"knee", "LowerLeg"},     {"ankle", "Foot"}};
  const Skeleton skeleton = test::small_actor().skeleton;
  EXPECT_EQ(skeleton.n_bones(), 15);
  for (const Bone& bone : skeleton.bones) {
    std::string expected = bone.name == "root" ? "Hips" : bone.name == "chest" ? "Chest" : "Neck";
    if (const size_t side = bone.name.find('_'); side != std::string::npos)
      expected = (bone.name.substr(0, side) == "left" ? "Left" : "Right") + limbs.at(bone.name.substr(side + 1));
    EXPECT_EQ(vmc_bone_name(bone.name), expected);
  }
  EXPECT_EQ(vmc_bone_name("tail"), "");
}

}  // namespace
}  // namespace livecap
