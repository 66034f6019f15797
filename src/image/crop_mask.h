// A network's person mask as it was seen: of a crop of the image, not laid over the image yet.
#pragma once

#include "base/image_rgb.h"
#include "image/affine_warp.h"
#include "image/person_gate.h"

namespace livecap {

struct CropMask {
  ImageGray probability;      // of the crop, square, 255 = 1
  AffineMap mask_from_image;  // where the crop's mask has an image's pixel
  PixelBox box;               // pixels of the image that may not be 0
};

}  // namespace livecap
