// The bones of a built actor: where the network's keypoints put them in the mesh, with equal lengths left and right
// (paper, "Actor Model Acquisition": there by hand).
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "acquire/keypoints.h"
#include "acquire/person_frame.h"
#include "scan/volume.h"

namespace livecap::acquire {

// Mixamo's names, so that other programs know the rig; `extras` are not needed to load it.
enum BodyBone : int {
  kHipsBone,
  kSpineBone,
  kNeckBone,
  kHeadBone,
  kLeftClavicleBone,
  kLeftArmBone,
  kLeftForeArmBone,
  kLeftHandBone,
  kLeftKnuckleBone,
  kRightClavicleBone,
  kRightArmBone,
  kRightForeArmBone,
  kRightHandBone,
  kRightKnuckleBone,
  kLeftUpLegBone,
  kLeftLegBone,
  kLeftFootBone,
  kLeftToeBone,
  kRightUpLegBone,
  kRightLegBone,
  kRightFootBone,
  kRightToeBone,
  kBodyBoneCount
};

struct BodyBoneInfo {
  const char* name;        // in the file
  int parent;              // -1 for the root; parents come first
  const char* joint_name;  // in joints.json (LiveCap's names)
};
extern const std::array<BodyBoneInfo, kBodyBoneCount> kBodyBones;

using BodyJoints = std::array<Eigen::Vector3d, kBodyBoneCount>;  // mm, rest frame

// keypoints: rest frame. height_mm: of the body. volume: the body's inside; elbows, wrists, knees and ankles are put
// into the middle of a limb when one is around them. Throws ConfigError naming a keypoint that is needed and missing.
BodyJoints place_joints(const SpaceKeypoints& keypoints, double height_mm, const Volume& volume,
                        std::vector<std::string>& notes);

// Makes the lengths of left and right bones equal (their mean), keeping directions, from the hips outwards.
void make_symmetric(BodyJoints& joints);

// {"left_elbow": [x, y, z], ...} in the world of views or scan, or {"unit": "cm", "joints": {...}}. Throws IoError.
struct GivenJoints {
  std::map<std::string, Eigen::Vector3d> world;  // by joint name
  double unit_mm = 0;                            // 0: that of the world

  double to_world(const PersonFrame& frame) const { return unit_mm > 0 ? unit_mm / frame.scale_mm : 1; }
};
GivenJoints read_joints(const std::filesystem::path& path);

// Keypoints, in the world, that were not found take the place of the given joint of their name. They have no inliers.
void take_given(const GivenJoints& given, const PersonFrame& frame, SpaceKeypoints& world);

// Throws ConfigError naming a keypoint that place_joints needs and that is neither found nor given. or_else: what would
// help as well.
void require_keypoints(const SpaceKeypoints& keypoints, const GivenJoints& given = {}, const std::string& or_else = {});

void override_joints(const GivenJoints& given, const PersonFrame& frame, BodyJoints& joints);

// Where the four face markers are, rest frame: as given (names left_eye, right_eye, nose, chin), else as seen, else not
// at all.
std::map<std::string, Eigen::Vector3d> face_markers(const SpaceKeypoints& keypoints, const GivenJoints& given,
                                                    const PersonFrame& frame);

}  // namespace livecap::acquire
