// What an actor build should find: surface and bones of an actor whose every part is known.
#pragma once

#include <string>

#include "acquire/body_rig.h"
#include "actor/actor.h"
#include "actor/livecap_skeleton.h"
#include "geometry/skeleton.h"
#include "meshing/isosurface.h"
#include "meshing/surface_parts.h"
#include "support/builtin_actor.h"

namespace livecap::test {

inline meshing::Surface surface_of(const Actor& actor) {
  return meshing::surface_of(actor.mesh);
}

// Where the actor's own rig has the bones of a built one.
inline acquire::BodyJoints true_joints(const Actor& actor) {
  const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
  acquire::BodyJoints joints;
  for (int bone = 0; bone < acquire::kBodyBoneCount; ++bone) {
    const std::string name = acquire::kBodyBones[bone].joint_name;
    if (const int index = actor.skeleton.bone_index(name); index >= 0)
      joints[bone] = rest.camera_from_bone[index].translation();
    for (int k = 0; k < kKeypointCount; ++k)
      if (name == kKeypointNames[k] && actor.skeleton.bone_index(name) < 0)
        joints[bone] = actor.keypoints[k].rest_position_mm;
  }
  joints[acquire::kSpineBone] =
      (1 - kChestHeight) * joints[acquire::kHipsBone] + kChestHeight * joints[acquire::kNeckBone];
  const Eigen::Vector3d top = actor.keypoints[kHeadTop].rest_position_mm;
  joints[acquire::kHeadBone] = 0.7 * joints[acquire::kNeckBone] + 0.3 * top;
  return joints;
}

}  // namespace livecap::test
