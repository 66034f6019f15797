// Where a shoe ends and its shadow on the floor begins. By their colours a white sole in its own shade and a grey floor
// are alike, and so are a dark shoe and the shadow beside it. But a shadow darkens the floor smoothly, and a shoe does
// not: divided by the empty picture and by how dark the floor beside a place is, a floor is grey all over, and what is
// not is the person.
#pragma once

#include "base/image_rgb.h"

namespace livecap {

// Cuts the feet, the lowest 12 % of the mask, out of their shadows: a minimum cut (Boykov and Jolly,
// "Interactive graph cuts for optimal boundary and region segmentation of objects in N-D images", 2001), after which
// more of the floor tells how dark it is, a few times over. plate: the empty scene; known: where that is right (0: not;
// whom the mask has there stays). All of one size; a mask without anybody stays.
void cut_feet_from_shadows(const ImageRgb& plate, const ImageGray& known, const ImageRgb& image, ImageGray& mask);

}  // namespace livecap
