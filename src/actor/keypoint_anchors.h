// Where the 23 observation keypoints sit on an actor (docs/formats.md): joints, extremities and face markers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "actor/bone_names.h"
#include "actor/livecap_skeleton.h"

namespace livecap {

// Where the head begins of somebody without a head joint: so far from the neck joint to the top.
inline constexpr double kChinHeight = 0.35;

struct AnchorInput {
  RigPositions joints_mm;                             // rest frame
  std::array<bool, kRigJointCount> joint_found{};     // joints without a position get a guess from the mesh
  std::map<std::string, int> marker_vertices;         // keypoint name -> template vertex
  std::map<std::string, Eigen::Vector3d> offsets_mm;  // keypoint name -> added to the default position
};

// mesh and skin are the finished template in the rest frame. Guesses are reported in `notes`.
std::array<KeypointAnchor, kKeypointCount> place_keypoints(const AnchorInput& input, const Mesh& mesh,
                                                           const SkinWeights& skin, std::vector<std::string>& notes);

}  // namespace livecap
