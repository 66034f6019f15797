#include "actor/bone_names.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace livecap {

const std::array<std::string_view, kRigJointCount> kRigJointNames = {
    "root",           "chest",          "neck",        "left_clavicle", "left_shoulder", "left_elbow",
    "right_clavicle", "right_shoulder", "right_elbow", "left_hip",      "left_knee",     "left_ankle",
    "right_hip",      "right_knee",     "right_ankle", "left_wrist",    "right_wrist",   "left_toe",
    "right_toe",      "head",           "left_hand",   "right_hand",    "head_top"};

bool rig_joint_required(int joint) {
  return joint <= kRigRightWrist && joint != kRigChest && joint != kRigLeftClavicle && joint != kRigRightClavicle;
}

namespace {

struct Table {
  const char* name;
  // Normalised; several names of one joint, the first that the file has, stand between bars.
  std::array<const char*, kRigJointCount> bones;
};

constexpr Table kTables[] = {
    {"Mixamo",
     {"hips",
      "spine2|spine1|spine",
      "neck",
      "leftshoulder",
      "leftarm",
      "leftforearm",
      "rightshoulder",
      "rightarm",
      "rightforearm",
      "leftupleg",
      "leftleg",
      "leftfoot",
      "rightupleg",
      "rightleg",
      "rightfoot",
      "lefthand",
      "righthand",
      "lefttoebase",
      "righttoebase",
      "head",
      "lefthandmiddle1",
      "righthandmiddle1",
      "headtopend"}},
    {"UE/MakeHuman", {"pelvis",    "spine03|spine02|spine01",
                      "neck01",    "claviclel",
                      "upperarml", "lowerarml",
                      "clavicler", "upperarmr",
                      "lowerarmr", "thighl",
                      "calfl",     "footl",
                      "thighr",    "calfr",
                      "footr",     "handl",
                      "handr",     "balll",
                      "ballr",     "head",
                      "middle01l", "middle01r",
                      "headend"}},
    {"LiveCap", {"root",          "chest",         "neck",       "leftclavicle", "leftshoulder", "leftelbow",
                 "rightclavicle", "rightshoulder", "rightelbow", "lefthip",      "leftknee",     "leftankle",
                 "righthip",      "rightknee",     "rightankle", "leftwrist",    "rightwrist",   "lefttoe",
                 "righttoe",      "head",          "lefthand",   "righthand",    "headtop"}},
    // The skeletons of VNect and DeepCap (root in the middle of the trunk, spine_1 the pelvis, hands that turn at the
    // wrist), and the joints of MPI-INF-3DHP (pelvis, wrists).
    {"Skeletool",
     {"pelvis|spine1|root",
      "spine4|spine3|spine2|chest",
      "neck|neck1",
      "leftclavicle",
      "leftshoulder",
      "leftelbow",
      "rightclavicle",
      "rightshoulder",
      "rightelbow",
      "lefthip",
      "leftknee",
      "leftankle",
      "righthip",
      "rightknee",
      "rightankle",
      "leftwrist|lefthand|leftlowarm",
      "rightwrist|righthand|rightlowarm",
      "lefttoes|leftfoot|lefttoe",
      "righttoes|rightfoot|righttoe",
      "head|neck2",
      "",
      "",
      "headtop|headee"}},
};

// "mixamorig1:LeftUpLeg" -> "leftupleg", "upperarm_l" -> "upperarml".
std::string normalized(const std::string& name) {
  std::string text;
  for (char c : name.substr(name.find_last_of(":|") + 1)) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  const std::string prefix = "mixamorig";
  if (text.rfind(prefix, 0) == 0) {
    size_t end = prefix.size();
    while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
    if (end < text.size()) text = text.substr(end);
  }
  return text;
}

// The place of the first of the names between the bars; -1: there is none.
int index_of_any(const std::vector<std::string>& plain, const char* names) {
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, '|');) {
    const auto found = std::find(plain.begin(), plain.end(), name);
    if (found != plain.end()) return static_cast<int>(found - plain.begin());
  }
  return -1;
}

}  // namespace

RigMatch match_rig(const std::vector<std::string>& names, const std::map<std::string, std::string>& overrides,
                   std::vector<std::string>& notes) {
  std::vector<std::string> plain;
  for (const std::string& name : names) plain.push_back(normalized(name));
  RigMatch best;
  int best_score = -1;
  for (const Table& table : kTables) {
    RigMatch match;
    match.table = table.name;
    int score = 0;
    for (int j = 0; j < kRigJointCount; ++j) {
      match.index[j] = index_of_any(plain, table.bones[j]);
      if (match.index[j] >= 0) score += rig_joint_required(j) ? 100 : 1;
    }
    if (score > best_score) {
      best_score = score;
      best = match;
    }
  }
  for (const auto& [joint, bone] : overrides) {
    const auto known = std::find(kRigJointNames.begin(), kRigJointNames.end(), joint);
    const auto found = std::find(names.begin(), names.end(), bone);
    if (known == kRigJointNames.end()) {
      notes.push_back("extras.livecap.bones: there is no joint \"" + joint + "\"; ignored");
    } else if (found == names.end()) {
      notes.push_back("extras.livecap.bones." + joint + ": there is no bone \"" + bone + "\"; ignored");
    } else {
      best.index[known - kRigJointNames.begin()] = static_cast<int>(found - names.begin());
    }
  }
  return best;
}

}  // namespace livecap
