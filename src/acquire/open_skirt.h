// The underside of a skirt or a dress, which no camera sees. Silhouettes close it with a lid at the hem; cloth is open
// there.
#pragma once

#include "acquire/keypoints.h"
#include "scan/volume.h"

namespace livecap::acquire {

// Takes a roof at 35 degrees that begins 40 mm inside of the cloth, and is no higher than 60 mm, out of what is inside
// of a ring of cloth around both legs, from the hem upwards; the legs in it go on as they are below. keypoints: in the
// volume's frame; hips, knees and ankles are needed. False, and nothing changed, when no ring of cloth goes around both
// legs well below the hips, or nothing in it lies far enough inside.
bool open_skirt(const SpaceKeypoints& keypoints, Volume& volume);

}  // namespace livecap::acquire
