// Turned, scaled and shifted copies of pictures.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image_rgb.h"

namespace livecap {

// An affine map of pixel positions, pixel centres at integers: x = xx u + xy v + x0, y = yx u + yy v + y0.
struct AffineMap {
  double xx = 1, xy = 0, x0 = 0;
  double yx = 0, yy = 1, y0 = 0;
};

// out(u, v) = in(map(u, v)), bilinear, black where that is outside. `out` has its size already; other pictures than
// `in` only. Throws LogicError when pixels do not match a size.
void warp_affine(const ImageRgb& in, const AffineMap& in_from_out, ImageRgb& out);
void warp_affine(const ImageGray& in, const AffineMap& in_from_out, ImageGray& out);

// The same for the pixels [x_begin, x_end) x [y_begin, y_end) of `out`, which lie in it (LogicError); the others stay.
void warp_affine(const ImageGray& in, const AffineMap& in_from_out, int x_begin, int y_begin, int x_end, int y_end,
                 ImageGray& out);

// The positions that warp_affine looks at for the pixels of a width x height picture, for kernels/image/warp_point.h:
// x and y of each column, then of each row, whose sums they are.
std::vector<int32_t> fixed_steps(const AffineMap& in_from_out, int width, int height);

// A rectangle of a picture, shrunk by a whole factor: means of factor x factor pixels. The rectangle lies in the
// picture (LogicError); columns and rows that do not fill a block are left out.
void shrink(const ImageRgb& in, int x_begin, int y_begin, int x_end, int y_end, int factor, ImageRgb& out);

}  // namespace livecap
