#include "picture/side_by_side.h"

#include <algorithm>

#include "livecap/error.h"

namespace livecap {

ImageRgb side_by_side(std::span<const ImageRgb> pictures, int gap_px) {
  if (pictures.empty()) throw LogicError("no pictures to put side by side");
  ImageRgb row{-gap_px, pictures.front().height, {}};
  for (const ImageRgb& picture : pictures) {
    if (picture.height != row.height) throw LogicError("pictures side by side must have one height");
    row.width += picture.width + gap_px;
  }
  row.pixels.assign(size_t(3) * row.width * row.height, 255);
  int left = 0;
  for (const ImageRgb& picture : pictures) {
    for (int y = 0; y < row.height; ++y)
      std::copy_n(picture.pixels.begin() + size_t(3) * y * picture.width, size_t(3) * picture.width,
                  row.pixels.begin() + 3 * (size_t(y) * row.width + left));
    left += picture.width + gap_px;
  }
  return row;
}

}  // namespace livecap
