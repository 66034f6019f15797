#include "acquire/body_rig.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "actor/livecap_skeleton.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr double kTableHeightMm = 1700;  // of the lengths below

// Where the middle joint of a limb lies along it: the network sees that of a sleeve or a trouser leg up to 23 mm off,
// the same in all pictures, while the two bones' lengths differ little in their ratio between people. `ratio`: outer
// over inner bone, the mean of women and men in P. de Leva, "Adjustments to Zatsiorsky-Seluyanov's segment inertia
// parameters", J. Biomechanics 29(9), 1996, table 4 (arm 264.3/275.1 and 268.9/281.7; leg, where women's thighs are
// measured shorter, the men's 434.0/422.2). `trust`: the share of it against the network, from the variances of both.
struct Proportion {
  double ratio, trust;
};
constexpr Proportion kArm{0.958, 0.75}, kLeg{1.03, 0.5};

// `middle` moved along the limb from `inner` to `outer`.
Vector3d proportioned(const Vector3d& inner, const Vector3d& middle, const Vector3d& outer, const Proportion& limb) {
  const Vector3d along = outer - inner;
  const double share = (middle - inner).dot(along) / along.squaredNorm();
  return middle + limb.trust * (1 / (1 + limb.ratio) - share) * along;
}

// The middle of the limb's cross-section at p across `axis`: the mean of the inside points of a disc that are connected
// to p. False when the section is no limb: it reaches the disc's border (trunk, skirt) or there is none.
bool section_center(const Volume& volume, const Vector3d& p, const Vector3d& axis, double radius_mm, Vector3d& center) {
  const double step = 4;
  const int half = static_cast<int>(std::ceil(radius_mm / step)), side = 2 * half + 1;
  const Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  const auto point = [&](int i, int j) { return Vector3d(p + step * ((i - half) * u + (j - half) * v)); };
  std::vector<char> inside(side * side), reached(side * side, 0);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) inside[j * side + i] = volume.at(point(i, j)) < 0;
  // Start at the inside point nearest to p.
  int start = -1, best = 1 << 30;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      if (const int d = (i - half) * (i - half) + (j - half) * (j - half); inside[j * side + i] && d < best)
        best = d, start = j * side + i;
  if (start < 0 || best * step * step > 0.5 * radius_mm * radius_mm) return false;
  std::vector<int> queue{start};
  reached[start] = 1;
  Vector3d sum = Vector3d::Zero();
  for (size_t next = 0; next < queue.size(); ++next) {
    const int i = queue[next] % side, j = queue[next] / side;
    if (std::hypot(i - half, j - half) >= half - 0.5) return false;
    sum += point(i, j);
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      if (const int other = (j + dj) * side + i + di; inside[other] && !reached[other]) {
        reached[other] = 1;
        queue.push_back(other);
      }
  }
  center = sum / static_cast<double>(queue.size());
  return true;
}

}  // namespace

const std::array<BodyBoneInfo, kBodyBoneCount> kBodyBones = {{
    {"Hips", -1, "root"},
    {"Spine", kHipsBone, "spine"},
    {"Neck", kSpineBone, "neck"},
    {"Head", kNeckBone, "head"},
    {"LeftShoulder", kSpineBone, "left_clavicle"},
    {"LeftArm", kLeftClavicleBone, "left_shoulder"},
    {"LeftForeArm", kLeftArmBone, "left_elbow"},
    {"LeftHand", kLeftForeArmBone, "left_wrist"},
    {"LeftHandMiddle1", kLeftHandBone, "left_hand"},
    {"RightShoulder", kSpineBone, "right_clavicle"},
    {"RightArm", kRightClavicleBone, "right_shoulder"},
    {"RightForeArm", kRightArmBone, "right_elbow"},
    {"RightHand", kRightForeArmBone, "right_wrist"},
    {"RightHandMiddle1", kRightHandBone, "right_hand"},
    {"LeftUpLeg", kHipsBone, "left_hip"},
    {"LeftLeg", kLeftUpLegBone, "left_knee"},
    {"LeftFoot", kLeftLegBone, "left_ankle"},
    {"LeftToeBase", kLeftFootBone, "left_toe"},
    {"RightUpLeg", kHipsBone, "right_hip"},
    {"RightLeg", kRightUpLegBone, "right_knee"},
    {"RightFoot", kRightLegBone, "right_ankle"},
    {"RightToeBase", kRightFootBone, "right_toe"},
}};

BodyJoints place_joints(const SpaceKeypoints& keypoints, double height_mm, const Volume& volume,
                        std::vector<std::string>& notes) {
  const double s = height_mm / kTableHeightMm;
  require_keypoints(keypoints);
  const auto at = [&](int k) { return keypoints[k].position; };
  // What the network calls by these names is not where a joint turns: actor/keypoint_offsets.cpp the other way round,
  // and what is left in the mean of three actors standing in A-pose (docs/actor_build.md): the shoulders lie farther
  // out and the hips lower than in motion.
  BodyJoints joints;
  struct Side {
    int hip, knee, ankle, toe, shoulder, elbow, wrist, hand;  // keypoints
    int leg, arm;                                             // first bones
    double out;
  };
  constexpr Side kSides[2] = {{kLeftHip, kLeftKnee, kLeftAnkle, kLeftToe, kLeftShoulder, kLeftElbow, kLeftWrist,
                               kLeftHand, kLeftUpLegBone, kLeftArmBone, 1},
                              {kRightHip, kRightKnee, kRightAnkle, kRightToe, kRightShoulder, kRightElbow, kRightWrist,
                               kRightHand, kRightUpLegBone, kRightArmBone, -1}};
  int n_centered = 0;
  for (const Side& side : kSides) {
    joints[side.leg] = at(side.hip) + s * Vector3d(-side.out * 5, 21, -4);
    joints[side.leg + 1] = at(side.knee);
    joints[side.leg + 2] = at(side.ankle) - s * Vector3d(0, 17, 22);
    joints[side.leg + 3] = at(side.toe) - s * Vector3d(0, -15, 40);
    joints[side.arm] = at(side.shoulder) - s * Vector3d(side.out * 19, 20, 9);
    joints[side.arm + 1] = at(side.elbow) - s * Vector3d(0, 0, 12);
    const Vector3d along = (at(side.wrist) - at(side.elbow)).normalized();
    joints[side.arm + 2] = at(side.wrist) - s * 15 * along;
    joints[side.leg + 1] = proportioned(joints[side.leg], joints[side.leg + 1], joints[side.leg + 2], kLeg);
    joints[side.arm + 1] = proportioned(joints[side.arm], joints[side.arm + 1], joints[side.arm + 2], kArm);
    const auto center = [&](int bone, const Vector3d& axis, double radius) {
      Vector3d middle;
      if (section_center(volume, joints[bone], axis.normalized(), s * radius, middle)) {
        joints[bone] = middle;
        ++n_centered;
      }
    };
    center(side.leg + 1, joints[side.leg + 2] - joints[side.leg], 105);
    center(side.leg + 2, joints[side.leg + 1] - joints[side.leg + 2], 80);
    center(side.arm + 1, joints[side.arm + 2] - joints[side.arm], 80);
    center(side.arm + 2, along, 60);
    // The network's hand leans towards the thumb; in rigs, and for the anchors of capture, a hand at rest is in line
    // with its forearm.
    joints[side.arm + 3] = joints[side.arm + 2] + (at(side.hand) - at(side.wrist)).norm() / 0.6 *
                                                      (joints[side.arm + 2] - joints[side.arm + 1]).normalized();
  }
  if (n_centered < 8)
    notes.push_back(
        format("%d of 8 limb joints could not be put into the middle of a limb (wide clothes?); the "
               "network's places are kept",
               8 - n_centered));
  const Vector3d hips = (joints[kLeftUpLegBone] + joints[kRightUpLegBone]) / 2;
  const Vector3d shoulders = (joints[kLeftArmBone] + joints[kRightArmBone]) / 2;
  const Vector3d up = (shoulders - hips).normalized();
  joints[kHipsBone] = hips + s * 38 * up;
  joints[kNeckBone] = shoulders + s * (75 * up - Vector3d(0, 0, 8));
  joints[kSpineBone] = (1 - kChestHeight) * joints[kHipsBone] + kChestHeight * joints[kNeckBone];
  const bool eyes = keypoints[kLeftEye].found && keypoints[kRightEye].found;
  const double eye_level = eyes ? (at(kLeftEye).y() + at(kRightEye).y()) / 2 : joints[kNeckBone].y() + s * 170;
  joints[kHeadBone] =
      joints[kNeckBone] + Vector3d(0, std::max(s * 30, 0.5 * (eye_level - joints[kNeckBone].y())), s * 8);
  for (const auto& [clavicle, arm] :
       {std::pair{kLeftClavicleBone, kLeftArmBone}, {kRightClavicleBone, kRightArmBone}}) {
    const Vector3d root = joints[kNeckBone] - s * 40 * up;
    joints[clavicle] = root + 0.25 * (joints[arm] - root);
  }
  return joints;
}

void make_symmetric(BodyJoints& joints) {
  const BodyJoints from = joints;
  const int n_side = kRightClavicleBone - kLeftClavicleBone;
  const auto pair = [&](int left, int right) {
    const int left_parent = kBodyBones[left].parent, right_parent = kBodyBones[right].parent;
    const Vector3d l = from[left] - from[left_parent], r = from[right] - from[right_parent];
    const double length = (l.norm() + r.norm()) / 2;
    joints[left] = joints[left_parent] + length * l.normalized();
    joints[right] = joints[right_parent] + length * r.normalized();
  };
  for (int bone = kLeftClavicleBone; bone < kRightClavicleBone; ++bone) pair(bone, bone + n_side);
  for (int bone = kLeftUpLegBone; bone < kRightUpLegBone; ++bone) pair(bone, bone + 4);
}

namespace {

constexpr Keypoint kFaceMarkers[] = {kLeftEye, kRightEye, kNose, kChin};

bool is_face_marker(const std::string& name) {
  return std::any_of(std::begin(kFaceMarkers), std::end(kFaceMarkers),
                     [&](Keypoint k) { return name == kKeypointNames[k]; });
}

}  // namespace

GivenJoints read_joints(const std::filesystem::path& path) {
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(read_file(path));
  } catch (const nlohmann::json::exception& error) {
    throw IoError(path.string() + ": not valid JSON: " + error.what());
  }
  GivenJoints given;
  if (!json.is_object()) throw IoError(path.string() + ": expected an object {\"left_elbow\": [x, y, z], ...}");
  if (json.contains("unit")) {
    if (!json["unit"].is_string()) throw IoError(path.string() + ": unit must be m, cm, mm or inch");
    try {
      given.unit_mm = unit_in_mm(json["unit"].get<std::string>());
    } catch (const ConfigError&) {  // which names the option
      throw IoError(path.string() + ": unit is \"" + json["unit"].get<std::string>() + "\", must be m, cm, mm or inch");
    }
  }
  const nlohmann::json& list = json.contains("joints") ? json["joints"] : json;
  for (const auto& [name, value] : list.items()) {
    if (name == "unit") continue;
    const bool known = std::any_of(kBodyBones.begin(), kBodyBones.end(),
                                   [&n = name](const BodyBoneInfo& bone) { return n == bone.joint_name; });
    if (!known && !is_face_marker(name)) throw IoError(path.string() + ": there is no joint \"" + name + "\"");
    Vector3d p;
    for (int k = 0; k < 3; ++k) {
      if (!value.is_array() || value.size() != 3 || !value[k].is_number())
        throw IoError(path.string() + ": " + name + " must be [x, y, z]");
      p[k] = value[k].get<double>();
    }
    given.world[name] = p;
  }
  return given;
}

void take_given(const GivenJoints& given, const PersonFrame& frame, SpaceKeypoints& world) {
  for (int k = kLeftHip; k <= kRightToe; ++k) {
    const auto found = given.world.find(std::string(kKeypointNames[k]));
    if (world[k].found || found == given.world.end()) continue;
    world[k] = {true, given.to_world(frame) * found->second};
  }
}

void require_keypoints(const SpaceKeypoints& keypoints, const GivenJoints& given, const std::string& or_else) {
  for (int k = kLeftHip; k <= kRightToe; ++k)  // hips, shoulders and limbs
    if (const std::string name(kKeypointNames[k]); !keypoints[k].found && !given.world.count(name))
      throw ConfigError("the network's " + name +
                        " does not agree between the pictures: one person, standing still, seen whole from all around "
                        "is needed" +
                        or_else);
}

void override_joints(const GivenJoints& given, const PersonFrame& frame, BodyJoints& joints) {
  const double to_world = given.to_world(frame);
  for (int bone = 0; bone < kBodyBoneCount; ++bone)
    if (const auto found = given.world.find(kBodyBones[bone].joint_name); found != given.world.end())
      joints[bone] = frame.to_rest(to_world * found->second);
}

std::map<std::string, Vector3d> face_markers(const SpaceKeypoints& keypoints, const GivenJoints& given,
                                             const PersonFrame& frame) {
  const double to_world = given.to_world(frame);
  std::map<std::string, Vector3d> markers;
  for (Keypoint k : kFaceMarkers) {
    const std::string name(kKeypointNames[k]);
    if (const auto found = given.world.find(name); found != given.world.end())
      markers[name] = frame.to_rest(to_world * found->second);
    else if (keypoints[k].found)
      markers[name] = keypoints[k].position;
  }
  return markers;
}

}  // namespace livecap::acquire
