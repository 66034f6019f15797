// Which bones of a Skeletool skeleton are LiveCap's joints (docs/actor_build.md, "From a Skeletool template").
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "acquire/body_rig.h"
#include "actor/bone_names.h"
#include "actor/livecap_skeleton.h"
#include "actor/skeletool.h"
#include "meshing/actor_glb.h"

namespace livecap::acquire {

using RigBones = std::array<int, kRigJointCount>;  // index = RigJoint; bone of the skeleton, -1: there is none

// By the names of the bones; the pelvis is the bone where the legs part, the chest the one where the arms do. `named`:
// {"left_wrist": "left_lowarm", ...}, LiveCap's joint and a bone or joint of the skeleton, which wins; empty: none.
// file: of the skeleton, for messages. Throws IoError naming what is missing or unknown.
RigBones find_rig(const SkeletoolSkeleton& skeleton, const std::filesystem::path& file,
                  const std::filesystem::path& named);

// Where the joints are at zero angles, mm, the skeleton's own axes; zero where there is none.
RigPositions rig_positions(const SkeletoolSkeleton& skeleton, const RigBones& rig);

// The bone of a built actor that each bone of the skeleton counts as: that of the nearest joint of the rig towards the
// root. [n_bones]
std::vector<BodyBone> body_bones(const SkeletoolSkeleton& skeleton, const RigBones& rig);

// The influences of bones that count as the same one are one, strongest first. bones: of body_bones().
meshing::Influences body_influences(const meshing::Influences& influences, const std::vector<BodyBone>& bones);

// Where a built actor has its bones, given the rig's joints in the rest frame; ends that the rig lacks are at the joint
// before them, a missing head as high between neck and top as heads are. top_mm: of the mesh.
BodyJoints body_joints(const RigPositions& joints_mm, const RigBones& rig, double top_mm);

}  // namespace livecap::acquire
