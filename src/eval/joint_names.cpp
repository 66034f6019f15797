#include "eval/joint_names.h"

#include <algorithm>
#include <cctype>

namespace livecap {
namespace {

struct Names {
  const char* captured;
  const char* mixamo;
  const char* ue;
};

constexpr Names kJoints[] = {
    {"root", "Hips", "pelvis"},
    {"neck", "Neck", "neck_01"},
    {"left_shoulder", "LeftArm", "upperarm_l"},
    {"left_elbow", "LeftForeArm", "lowerarm_l"},
    {"left_wrist", "LeftHand", "hand_l"},
    {"right_shoulder", "RightArm", "upperarm_r"},
    {"right_elbow", "RightForeArm", "lowerarm_r"},
    {"right_wrist", "RightHand", "hand_r"},
    {"left_hip", "LeftUpLeg", "thigh_l"},
    {"left_knee", "LeftLeg", "calf_l"},
    {"left_ankle", "LeftFoot", "foot_l"},
    {"right_hip", "RightUpLeg", "thigh_r"},
    {"right_knee", "RightLeg", "calf_r"},
    {"right_ankle", "RightFoot", "foot_r"},
};

std::string without_prefix(const std::string& name) {
  return name.substr(name.find_last_of(":|") + 1);
}

int index_of_joint(const std::vector<std::string>& names, const std::string& wanted) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const std::string& name) { return without_prefix(name) == wanted; });
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

// Every joint, -1 on the sides that do not have it.
std::vector<JointPair> all_joints(const std::vector<std::string>& captured, const std::vector<std::string>& truth) {
  std::vector<JointPair> pairs;
  for (const Names& joint : kJoints) {
    JointPair pair{joint.captured, index_of_joint(captured, joint.captured), index_of_joint(truth, joint.captured)};
    if (pair.captured < 0 && pair.name == "root") pair.captured = index_of_joint(captured, "pelvis");
    if (pair.truth < 0) pair.truth = index_of_joint(truth, joint.mixamo);
    if (pair.truth < 0) pair.truth = index_of_joint(truth, joint.ue);
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace

std::vector<JointPair> match_joints(const std::vector<std::string>& captured, const std::vector<std::string>& truth) {
  std::vector<JointPair> pairs = all_joints(captured, truth);
  std::erase_if(pairs, [](const JointPair& pair) { return pair.captured < 0 || pair.truth < 0; });
  return pairs;
}

std::vector<std::string> joints_not_captured(const std::vector<std::string>& captured,
                                             const std::vector<std::string>& truth) {
  std::vector<std::string> names;
  for (const JointPair& pair : all_joints(captured, truth)) {
    if (pair.captured < 0 && pair.truth >= 0) names.push_back(pair.name);
  }
  return names;
}

}  // namespace livecap
