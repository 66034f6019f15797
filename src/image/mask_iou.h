// Masks as pictures: a pixel >= 128 is the person.
#pragma once

#include "base/image_rgb.h"

namespace livecap {

// Intersection over union of the persons' pixels. 1 when neither picture has any. Throws LogicError when sizes differ.
double mask_iou(const ImageGray& a, const ImageGray& b);

bool mask_has_person(const ImageGray& mask);

}  // namespace livecap
