// Whole-number changes of size, for drawing finer than what is shown.
#pragma once

#include "base/image_rgb.h"

namespace livecap {

// Every pixel n times in both directions.
ImageRgb repeated(const ImageRgb& image, int n);

// The mean of every n x n pixels; what is left over at the right and below is cut off.
ImageRgb averaged(const ImageRgb& image, int n);

}  // namespace livecap
