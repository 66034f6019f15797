// What is decided about connected pieces of the person's mask, after what was decided about single pixels.
#pragma once

#include "base/detections.h"
#include "base/image_rgb.h"
#include "image/foreground.h"

namespace livecap {

// What the network does not call person and what goes on beyond the gate is no part of the person that the network
// missed but somebody else, when it is large there. Nearer than seam_px to the network's person it stays: the network's
// border is not exact enough to tell.
struct StrangerSearch {
  const PersonMask& network;
  PixelBox box;
  int seam_px;
  float least_share;  // a stranger is at least this share of the person
};

// n_beyond: pixels in the box that are neither the background nor in the gate.
bool may_be_strangers(const StrangerSearch& search, int n_beyond);

// True when so few surely are no stranger, told from the network's mask in cells (see find_person_gate) alone.
bool few_beyond(const ImageGray& cells, float least_share, int n_beyond);

// beyond: nonzero where a pixel is neither the background nor in the gate; the first one belongs to column 0 of the
// box's first row, rows are `stride` apart.
void drop_strangers(const StrangerSearch& search, const uint8_t* beyond, int stride, ImageGray& mask);

// Within the box: drops pieces smaller than min_part of the largest, then closes holes smaller than max_hole of what is
// left.
ForegroundResult clean_mask(const PixelBox& box, float min_part, float max_hole, ImageGray& mask);

}  // namespace livecap
