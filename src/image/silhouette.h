// The person's silhouette as a signed distance image (paper, "Input Stream Processing").
#pragma once

#include <vector>

#include "base/image_rgb.h"
#include "image/person_gate.h"

namespace livecap {

struct Silhouette {
  int width = 0;
  int height = 0;
  // [width*height] px, Euclidean distance to the silhouette contour: positive outside, negative inside, zero on the
  // contour between pixels. |signed_distance| is the paper's I_DT. Exact inside the person's box grown by
  // silhouette_margin_px(); beyond it an upper bound that rises away from the box without a step: the value at the
  // grown box's nearest pixel plus the distance to that pixel. Empty when nobody is in the picture.
  std::vector<float> signed_distance;
  int area_px = 0;  // foreground pixels
  PixelBox box;     // around all of them; empty when there are none
  bool empty() const { return area_px == 0; }
};

// How far around the person's box (its size in px) distances are exact.
int silhouette_margin_px(int box_width, int box_height);

// mask: > 127 is foreground. Throws LogicError for a malformed mask.
Silhouette make_silhouette(const ImageGray& mask);

// Signed distance at a place, px (pixel centres at integers), bilinear; beyond the picture's border the way to it is
// added. silhouette: not empty.
double distance_at(const Silhouette& silhouette, double x, double y);

}  // namespace livecap
