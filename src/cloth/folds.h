// How much of a garment lies in folds: cloth in folds is soft and lies on the legs, what stands wide without any is
// stiff (HangingClothOptions::taut, loose).
#pragma once

#include "actor/actor.h"

namespace livecap {

// What more cloth there is around than the shortest way around needs, as a share of that: 0 for a garment without
// folds (or without hanging cloth, or one that is open at a side), 0.1 where a tenth is in folds. Of horizontal
// sections of what hangs and moves with the legs, in the rest pose: their longest closed line against its convex hull.
double share_in_folds(const Actor& actor);

}  // namespace livecap
