// Which node of a rigged file is which LiveCap-32 joint, by the names rigs use (docs/formats.md).
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace livecap {

// Joints looked for in a file. The first kRigBoneCount become bones of the skeleton; the others are end points.
enum RigJoint : int {
  kRigRoot,
  kRigChest,
  kRigNeck,
  kRigLeftClavicle,
  kRigLeftShoulder,
  kRigLeftElbow,
  kRigRightClavicle,
  kRigRightShoulder,
  kRigRightElbow,
  kRigLeftHip,
  kRigLeftKnee,
  kRigLeftAnkle,
  kRigRightHip,
  kRigRightKnee,
  kRigRightAnkle,
  kRigBoneCount,
  kRigLeftWrist = kRigBoneCount,
  kRigRightWrist,
  kRigLeftToe,
  kRigRightToe,
  kRigHead,
  kRigLeftKnuckle,
  kRigRightKnuckle,
  kRigHeadTop,
  kRigJointCount
};

// LiveCap's own names: "root", "left_shoulder", ... These are also the names `extras.livecap.bones` uses.
extern const std::array<std::string_view, kRigJointCount> kRigJointNames;

bool rig_joint_required(int joint);

struct RigMatch {
  std::string table;                        // which naming matched: "Mixamo", "UE/MakeHuman", "LiveCap", "Skeletool"
  std::array<int, kRigJointCount> index{};  // into the given names, -1 when absent
};

// Best-matching table for the names; `overrides` (LiveCap joint name -> name in the file) win over it.
// Unknown names in `overrides` are reported through `notes`.
RigMatch match_rig(const std::vector<std::string>& names, const std::map<std::string, std::string>& overrides,
                   std::vector<std::string>& notes);

}  // namespace livecap
