// The masks of a turn before a static camera, from what is behind the person. A network's outlines are off by some
// millimetres; but what is beside the person in one picture of the turn is empty in others, so the pictures show the
// empty scene themselves.
#pragma once

#include <vector>

#include "ocl/context.h"
#include "views/view.h"

namespace livecap {

// The empty scene of pictures by one static camera.
struct TurnBackground {
  ImageRgb plate;
  ImageGray known;  // 0 where too few views show it: there somebody is always
};

// views: of one size; masks: of each, of the person, right within this share of their height. A view whose mask is
// empty shows nothing.
TurnBackground find_background(const std::vector<View>& views, const std::vector<ImageGray>& masks, double margin);

// Replaces the network's masks of the views by the difference to the empty scene, where that is known, with feet cut
// out of their shadows (views/foot_masks.h). False, and they stay, when that would make other people of them: the
// camera moved, or the light changed.
bool mask_by_background(ocl::DeviceContext& device, std::vector<View>& views);

}  // namespace livecap
