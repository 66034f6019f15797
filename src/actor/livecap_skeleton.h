// The LiveCap-32 chain (docs/formats.md) fitted to the joint positions of one actor.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "actor/bone_names.h"
#include "geometry/skeleton.h"

namespace livecap {

// Joint positions in the rest frame (mm, +X the subject's left, +Y up, +Z front), index = RigJoint. Only joints of
// bones and the wrists are used; every one of them must be set.
using RigPositions = std::array<Eigen::Vector3d, kRigJointCount>;

// How far up from the pelvis to the neck a rig without a bone there has its chest: as high as others have Spine2.
inline constexpr double kChestHeight = 0.65;

// Builds 15 bones (names and indices as RigJoint) and 32 joint angles with the rest angles the positions imply, so that
// forward kinematics at rest reproduces the positions. bends: whether the chest turns against the pelvis; else its
// three angles are left out, which skin that follows the pelvis alone needs. Limits come from the table there, replaced
// by `limits_deg` (joint angle name -> min, max in degrees). A ball joint's rest angle outside its limits widens them,
// with a note; a hinge keeps its limits and leaves the rest to the bone's offset.
Skeleton build_livecap_skeleton(const RigPositions& joints_mm, bool bends,
                                const std::map<std::string, std::pair<double, double>>& limits_deg,
                                std::vector<std::string>& notes);

}  // namespace livecap
