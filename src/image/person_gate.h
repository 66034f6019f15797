// Where the network says that the person may be, on a coarse grid: the gate, and the core that is the person in any
// case. Their borders are margins, not results.
#pragma once

#include "base/image_rgb.h"

namespace livecap {

struct ForegroundOptions;

// Pixels [x0, x1) x [y0, y1).
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
};

// Grown by `margin` on every side, within a picture of width x height.
PixelBox grown(const PixelBox& box, int margin, int width, int height);

// The smallest box around everything that is not 0.
PixelBox bounding_box(const ImageGray& mask);

constexpr int kGateCell = 4;  // px, side of a cell; LC_COARSE of kernels/image/layout.h

struct PersonGate {
  ImageGray gate;   // cells; 255 = may be the person
  ImageGray core;   // cells; 255 = is the person
  PixelBox search;  // what is looked at: the gate, and where strangers are looked for; empty: nobody
  int seam_px = 0;  // nearer to the network's person nothing is a stranger's
};

// cells: mean probability of each cell, 255 = 1. width, height: of the picture.
PersonGate find_person_gate(const ImageGray& cells, int width, int height, const ForegroundOptions& options);

// Grows what is not 0 by OpenCV's elliptic structuring element of this radius: a disc.
void grow_by_disc(ImageGray& mask, int radius);
// The same for what is 0; nothing comes in from outside the picture.
void shrink_by_disc(ImageGray& mask, int radius);

}  // namespace livecap
