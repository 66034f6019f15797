#include "acquire/template_rig.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "actor/keypoint_anchors.h"
#include "base/joined.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap::acquire {

namespace {

// The bone of a built actor that turns about a joint of the rig, or has it as its end. Index = RigJoint.
constexpr std::array<BodyBone, kRigJointCount> kBodyBoneOf = {
    kHipsBone,          kSpineBone,    kNeckBone,         kLeftClavicleBone, kLeftArmBone,   kLeftForeArmBone,
    kRightClavicleBone, kRightArmBone, kRightForeArmBone, kLeftUpLegBone,    kLeftLegBone,   kLeftFootBone,
    kRightUpLegBone,    kRightLegBone, kRightFootBone,    kLeftHandBone,     kRightHandBone, kLeftToeBone,
    kRightToeBone,      kHeadBone,     kLeftKnuckleBone,  kRightKnuckleBone, kHeadBone};

std::vector<std::string> bone_names(const SkeletoolSkeleton& skeleton) {
  std::vector<std::string> names;
  for (const Bone& bone : skeleton.skeleton.bones) names.push_back(bone.name);
  return names;
}

// {"left_wrist": "left_lowarm"} -> RigJoint and bone.
std::map<int, int> read_named(const std::filesystem::path& path, const SkeletoolSkeleton& skeleton) {
  const nlohmann::json json = nlohmann::json::parse(read_file(path), nullptr, false);
  if (!json.is_object())
    throw IoError(path.string() + ": is not a JSON object such as {\"left_wrist\": \"name of a bone\"}");
  std::map<int, int> named;
  for (const auto& [joint, value] : json.items()) {
    const std::string where = path.string() + ": field \"" + one_line(joint) + "\"";
    const auto known = std::find(kRigJointNames.begin(), kRigJointNames.end(), joint);
    if (known == kRigJointNames.end())
      throw IoError(where + ": there is no such joint; joints are " +
                    joined({kRigJointNames.begin(), kRigJointNames.end()}));
    if (!value.is_string()) throw IoError(where + ": must be the name of a bone");
    const std::string name = value.get<std::string>();
    int bone = skeleton.skeleton.bone_index(name);
    for (size_t i = 0; bone < 0 && i < skeleton.joint_names.size(); ++i)
      if (skeleton.joint_names[i] == name) bone = skeleton.bone_of_joint[i];
    if (bone < 0)
      throw IoError(where + ": the skeleton has no bone \"" + one_line(name) + "\"; its bones are " +
                    joined(bone_names(skeleton)));
    named[static_cast<int>(known - kRigJointNames.begin())] = bone;
  }
  return named;
}

// The bone that both hang from; parents stand before their children.
int common_ancestor(const Skeleton& skeleton, int a, int b) {
  while (a != b) (a > b ? a : b) = skeleton.bones[std::max(a, b)].parent;
  return a;
}

}  // namespace

RigBones find_rig(const SkeletoolSkeleton& skeleton, const std::filesystem::path& file,
                  const std::filesystem::path& named) {
  const std::map<int, int> given = named.empty() ? std::map<int, int>() : read_named(named, skeleton);
  std::vector<std::string> ignored;
  RigBones rig = match_rig(bone_names(skeleton), {}, ignored).index;
  for (const auto& [joint, bone] : given) rig[joint] = bone;
  std::vector<std::string> missing;
  for (int joint = 0; joint < kRigJointCount; ++joint)
    if (rig_joint_required(joint) && joint != kRigRoot && rig[joint] < 0)
      missing.push_back(std::string(kRigJointNames[joint]));
  if (!missing.empty())
    throw IoError(file.string() + ": no bone found for " + joined(missing) +
                  "; name them in a file for --bones, as {\"" + missing[0] + "\": \"name of a bone\"}; its bones are " +
                  joined(bone_names(skeleton)));
  const Skeleton& chain = skeleton.skeleton;
  if (!given.count(kRigRoot)) rig[kRigRoot] = common_ancestor(chain, rig[kRigLeftHip], rig[kRigRightHip]);
  if (!given.count(kRigChest)) {
    rig[kRigChest] = common_ancestor(chain, rig[kRigLeftShoulder], rig[kRigRightShoulder]);
    if (rig[kRigChest] == rig[kRigRoot]) rig[kRigChest] = -1;
  }
  std::map<int, int> joint_of;
  for (int joint = 0; joint < kRigBoneCount; ++joint) {
    if (rig[joint] < 0) continue;
    if (const auto [other, is_new] = joint_of.emplace(rig[joint], joint); !is_new)
      throw IoError(file.string() + ": " + std::string(kRigJointNames[joint]) + " and " +
                    std::string(kRigJointNames[other->second]) + " are both the bone \"" +
                    chain.bones[rig[joint]].name + "\"; name another in a file for --bones");
  }
  return rig;
}

RigPositions rig_positions(const SkeletoolSkeleton& skeleton, const RigBones& rig) {
  const PosedSkeleton rest = forward_kinematics(skeleton.skeleton, rest_pose(skeleton.skeleton));
  RigPositions positions;
  for (int joint = 0; joint < kRigJointCount; ++joint)
    positions[joint] = rig[joint] < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                      : Eigen::Vector3d(rest.camera_from_bone[rig[joint]].translation());
  return positions;
}

std::vector<BodyBone> body_bones(const SkeletoolSkeleton& skeleton, const RigBones& rig) {
  std::vector<BodyBone> result;
  for (const Bone& bone : skeleton.skeleton.bones) {
    const int index = static_cast<int>(result.size());
    const auto joint = std::find(rig.begin(), rig.end(), index);
    result.push_back(joint != rig.end() ? kBodyBoneOf[joint - rig.begin()]
                     : bone.parent < 0  ? kHipsBone
                                        : result[bone.parent]);
  }
  return result;
}

meshing::Influences body_influences(const meshing::Influences& influences, const std::vector<BodyBone>& bones) {
  meshing::Influences result;
  size_t n = 0;
  for (const meshing::Influence& slot : influences) {
    if (!(slot.weight > 0)) continue;
    const int bone = bones[slot.bone];
    const auto same = std::find_if(result.begin(), result.begin() + n,
                                   [&](const meshing::Influence& other) { return other.bone == bone; });
    if (same == result.begin() + n) result[n++].bone = bone;
    same->weight += slot.weight;
  }
  std::stable_sort(result.begin(), result.begin() + n,
                   [](const meshing::Influence& a, const meshing::Influence& b) { return a.weight > b.weight; });
  return result;
}

BodyJoints body_joints(const RigPositions& joints_mm, const RigBones& rig, double top_mm) {
  BodyJoints result;
  result.fill(joints_mm[kRigRoot]);
  std::array<bool, kBodyBoneCount> found{};
  for (int joint = 0; joint < kRigHeadTop; ++joint) {
    if (rig[joint] < 0) continue;
    result[kBodyBoneOf[joint]] = joints_mm[joint];
    found[kBodyBoneOf[joint]] = true;
  }
  for (int bone = 1; bone < kBodyBoneCount; ++bone)  // parents come first
    if (!found[bone]) result[bone] = result[kBodyBones[bone].parent];
  if (!found[kHeadBone]) result[kHeadBone].y() += kChinHeight * (top_mm - result[kHeadBone].y());
  return result;
}

}  // namespace livecap::acquire
