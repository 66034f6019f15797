// Skinning weights by heat diffusion from the bones (Baran & Popovic, "Automatic Rigging and Animation of 3D
// Characters", 2007): every vertex is in contact with the nearest bone it can see through the body, and the contact
// spreads over the surface, around a knee farther than elsewhere. Cloth that hangs around both legs at a distance is in
// contact with the hips as well, by the part of a leg's swing that the gap takes up.
#pragma once

#include <vector>

#include "acquire/body_rig.h"
#include "meshing/actor_glb.h"
#include "scan/volume.h"

namespace livecap::acquire {

// Strength of the contact, c in c/d^2: higher keeps vertices closer to their own bone.
inline constexpr double kContactHeat = 2.4;

// surface: closed, rest frame, mm. At most four bones of kBodyBones each, strongest first, sum 1.
std::vector<meshing::Influences> heat_weights(const meshing::Surface& surface, const BodyJoints& joints,
                                              const Volume& volume);

}  // namespace livecap::acquire
