#include "export/vmc.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <utility>

#include "export/export_frame.h"

namespace livecap {
namespace {

constexpr std::pair<std::string_view, std::string_view> kNames[] = {
    {"root", "Hips"},
    {"chest", "Chest"},
    {"neck", "Neck"},
    {"left_clavicle", "LeftShoulder"},
    {"left_shoulder", "LeftUpperArm"},
    {"left_elbow", "LeftLowerArm"},
    {"right_clavicle", "RightShoulder"},
    {"right_shoulder", "RightUpperArm"},
    {"right_elbow", "RightLowerArm"},
    {"left_hip", "LeftUpperLeg"},
    {"left_knee", "LeftLowerLeg"},
    {"left_ankle", "LeftFoot"},
    {"right_hip", "RightUpperLeg"},
    {"right_knee", "RightLowerLeg"},
    {"right_ankle", "RightFoot"},
};

// Open Sound Control 1.0: big-endian words of four bytes, strings padded with at least one zero.
class OscBytes {
 public:
  void word(uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<uint8_t>(value >> shift));
  }
  void number(float value) { word(std::bit_cast<uint32_t>(value)); }
  void text(std::string_view value) {
    bytes.insert(bytes.end(), value.begin(), value.end());
    bytes.resize(bytes.size() + 4 - value.size() % 4, 0);
  }
  std::vector<uint8_t> bytes;
};

// A bundle to be carried out at once.
class OscBundle : public OscBytes {
 public:
  OscBundle() {
    text("#bundle");
    word(0);
    word(1);
  }
  void add(const OscBytes& message) {
    word(static_cast<uint32_t>(message.bytes.size()));
    bytes.insert(bytes.end(), message.bytes.begin(), message.bytes.end());
  }
};

OscBytes message(std::string_view address, std::string_view types) {
  OscBytes osc;
  osc.text(address);
  osc.text(types);
  return osc;
}

// Right-handed, x to the left of who looks along z, as rest frame and glTF are, to Unity's left-handed: x is mirrored.
OscBytes transform(std::string_view address, std::string_view name, const Eigen::Vector3f& position,
                   const Eigen::Quaternionf& rotation) {
  OscBytes osc = message(address, ",sfffffff");
  osc.text(name);
  for (const float value : {-position.x(), position.y(), position.z()}) osc.number(value);
  for (const float value : {rotation.x(), -rotation.y(), -rotation.z(), rotation.w()}) osc.number(value);
  return osc;
}

// Unity's spine begins so far up from the pelvis to the chest. The upper chest begins with the chest: an avatar may
// have none.
constexpr float kSpine = 0.4f;

Eigen::Quaternionf quaternion(const std::array<float, 4>& xyzw) {
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

}  // namespace

std::string_view vmc_bone_name(std::string_view bone) {
  const auto* found =
      std::find_if(std::begin(kNames), std::end(kNames), [&](const auto& n) { return n.first == bone; });
  return found == std::end(kNames) ? std::string_view() : found->second;
}

VmcEncoder::VmcEncoder(const LiveActor& actor, const std::optional<FloorPlane>& floor) {
  const auto add = [&](std::string_view name, int index, const Eigen::Vector3f& offset) {
    bones_.push_back({std::string(name), index, {offset.x(), offset.y(), offset.z()}});
  };
  for (size_t b = 0; b < actor.bones.size(); ++b) {
    const Eigen::Vector3f offset = Eigen::Vector3f::Map(actor.bones[b].offset_m.data());
    const std::string_view name = vmc_bone_name(actor.bones[b].name);
    if (name.empty()) continue;
    const bool is_chest = name == "Chest";
    if (is_chest) add("Spine", -1, kSpine * offset);
    add(name, static_cast<int>(b), is_chest ? (1 - kSpine) * offset : offset);
    if (is_chest) add("UpperChest", -1, Eigen::Vector3f::Zero());
  }
  if (!floor) return;
  const Eigen::Quaterniond turn = upright_from_camera(Eigen::Vector3d::Map(floor->normal.data()));
  const Eigen::Quaternionf level = gltf_turn_from_camera(turn).cast<float>();
  level_ = {level.x(), level.y(), level.z(), level.w()};
  floor_y_m_ = static_cast<float>(-kMetresPerMm * floor->distance_mm);
}

std::vector<uint8_t> VmcEncoder::packet(const LiveResult& result) {
  const bool tracked = is_tracked(result.report.status);
  OscBundle bundle;
  OscBytes ok = message("/VMC/Ext/OK", ",i");
  ok.word(tracked ? 1 : 0);
  bundle.add(ok);
  OscBytes time = message("/VMC/Ext/T", ",f");
  time.number(static_cast<float>(result.report.pts_ms / 1000));
  bundle.add(time);
  if (!tracked) return bundle.bytes;

  const Eigen::Quaternionf level = quaternion(level_);
  const Eigen::Vector3f hips = level * Eigen::Vector3f::Map(result.bones.at(0).position_m.data());
  if (!floor_y_m_) {
    floor_y_m_ = hips.y();
    for (size_t i = 1; i < result.vertices_m.size(); i += 3) floor_y_m_ = std::min(*floor_y_m_, result.vertices_m[i]);
  }
  if (!middle_m_) middle_m_ = {hips.x(), *floor_y_m_, hips.z()};
  bundle.add(transform("/VMC/Ext/Root/Pos", "root", Eigen::Vector3f::Zero(), Eigen::Quaternionf::Identity()));
  for (const Bone& bone : bones_) {
    const Eigen::Quaternionf local =
        bone.index < 0 ? Eigen::Quaternionf::Identity() : quaternion(result.bones.at(bone.index).rotation);
    const bool is_root = bone.index == 0;
    bundle.add(transform("/VMC/Ext/Bone/Pos", bone.name,
                         is_root ? Eigen::Vector3f(hips - Eigen::Vector3f::Map(middle_m_->data()))
                                 : Eigen::Vector3f(Eigen::Vector3f::Map(bone.offset_m.data())),
                         is_root ? Eigen::Quaternionf(level * local) : local));
  }
  return bundle.bytes;
}

}  // namespace livecap
