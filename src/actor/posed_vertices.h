// Dual quaternion skinning on the host, in double: for pictures and checks; the tracker skins on its device.
#pragma once

#include <span>
#include <vector>

#include "actor/actor.h"

namespace livecap {

// Where the skeleton alone takes the template's vertices, [3*n_vertices] mm. dual_quats: [8*n_bones] of
// geometry/skeleton.h's bone_dual_quats.
std::vector<float> posed_vertices(const Actor& actor, std::span<const float> dual_quats);

}  // namespace livecap
