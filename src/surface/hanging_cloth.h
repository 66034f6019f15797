// How cloth that hangs from the waist follows the legs in stage II. Its skinning weights come from the nearest leg, but
// it is not fastened there: when a thigh moves forward, the back of a skirt stays hanging. E_smooth keeps the surface
// close to the skinned one wherever the picture says nothing, so V^S must not carry the back along.
#pragma once

#include "actor/actor.h"

namespace livecap {

// The actor's skinning weights, with less influence of the legs on hanging cloth (dress, coat, jumpsuit, skirt: the
// softest class of the paper's Table 1, rigidity of at most 1). A vertex whose weights on the legs sum to L keeps
// c L / (c + (1 - c) L) of them, c = leg_share in (0,1]: all of a small L, c of L = 1. The rest goes to the bone the
// legs hang from. leg_share = 1 changes nothing. Throws ConfigError.
SkinWeights hanging_cloth_weights(const Actor& actor, float leg_share);

}  // namespace livecap
