// The rotated square of the picture that the network sees, sampling it, and warping its mask back.
#pragma once

#include "base/detections.h"
#include "base/image_rgb.h"
#include "image/affine_warp.h"
#include "image/crop_mask.h"

namespace livecap::detect {

struct Point2 {
  double x = 0;
  double y = 0;
};

// A square of the image. Positions in the square are fractions of its side: (0,0) its upper left corner, (1,1) the
// lower right. Image coordinates have pixel centres at integers.
struct CropRegion {
  double center_x_px = 0;
  double center_y_px = 0;
  double side_px = 1;
  double angle_rad = 0;  // clockwise on the screen: the square's "up" is (sin, -cos) in the image

  Point2 image_from_crop(Point2 p) const;
  Point2 crop_from_image(Point2 p) const;
};

// The smallest square that holds the whole image.
CropRegion whole_image_crop(int width, int height);

// The blocks of factor x factor pixels that a crop is read from, and where among them its pixels lie.
struct CropBlocks {
  int factor = 1;
  int x_begin = 0, y_begin = 0, x_end = 0, y_end = 0;  // px of the image
  AffineMap from_crop;
};
CropBlocks crop_blocks(int width, int height, const CropRegion& crop, int size);

// Reads crops of an image; keeps its work memory between frames.
class CropSampler {
 public:
  // Writes size x size pixels. Bilinear, black outside the image (and in less than a block at its right and lower
  // border). Where the crop is shrunk by more than 1.5, image
  // pixels are averaged in blocks first, so that nothing aliases.
  void sample(const ImageRgb& image, const CropRegion& crop, int size, ImageRgb& out);

 private:
  ImageRgb blocks_;
};

// probability: square, over the crop, 255 = 1.
CropMask place_mask(const ImageGray& probability, const CropRegion& crop, int width, int height);

// The same laid over the image: writes the whole image's mask (bilinear; 0 outside the crop).
void warp_mask(const ImageGray& probability, const CropRegion& crop, int width, int height, PersonMask& mask);

}  // namespace livecap::detect
