// Outlines of a network's masks, moved to where the pictures have them: a network of 256 px is off by some pixels of a
// picture, and by all of a sole.
#pragma once

#include <functional>
#include <vector>

#include "views/view.h"

namespace livecap {

// Cuts the person out of `picture` (GrabCut: Rother, Kolmogorov and Blake 2004) near the outline of `mask`; further in
// and out the mask stays. Both of one size. Returns `mask` itself where that would make another person of it. The same
// for the same picture and mask.
ImageGray sharpened_mask(const ImageRgb& picture, const ImageGray& mask);

// That for the views of these indices, as many at a time as there are cores. progress: how many of them are done; it
// may throw.
void sharpen_masks(std::vector<View>& views, const std::vector<size_t>& which,
                   const std::function<void(int done, int total)>& progress);

}  // namespace livecap
