// Pictures in a row.
#pragma once

#include <span>

#include "base/image_rgb.h"

namespace livecap {

// From left to right, with white between them. LogicError where there is none or their heights differ.
ImageRgb side_by_side(std::span<const ImageRgb> pictures, int gap_px = 0);

}  // namespace livecap
