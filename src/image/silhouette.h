// The person's silhouette as a signed distance image (paper, "Input Stream Processing").
#pragma once

#include <vector>

#include "base/image_rgb.h"

namespace livecap {

struct Silhouette {
  int width = 0;
  int height = 0;
  // [width*height] px, Euclidean distance to the silhouette contour: positive outside, negative inside, zero on the
  // contour between pixels. |signed_distance| is the paper's I_DT. Empty when nobody is in the picture.
  std::vector<float> signed_distance;
  int area_px = 0;  // foreground pixels
  bool empty() const { return area_px == 0; }
};

// mask: > 127 is foreground. Exact Euclidean.
Silhouette make_silhouette(const ImageGray& mask);

}  // namespace livecap
