// Dual quaternion skinning on the host, in double: for pictures and checks; the tracker skins on its device.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "actor/actor.h"

namespace livecap {

// Where a point at rest goes that has the skinning weights of a vertex, mm. dual_quats: [8*n_bones] of
// geometry/skeleton.h's bone_dual_quats.
Eigen::Vector3d posed_point(std::span<const float> dual_quats, const SkinWeights& skin, int vertex,
                            const Eigen::Vector3d& rest_mm);

// Where the skeleton alone takes the template's vertices, [3*n_vertices] mm. dual_quats: as above.
std::vector<float> posed_vertices(const Actor& actor, std::span<const float> dual_quats);

}  // namespace livecap
