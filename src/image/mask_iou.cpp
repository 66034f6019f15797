#include "image/mask_iou.h"

#include <algorithm>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

bool is_person(uint8_t pixel) {
  return pixel >= 128;
}

}  // namespace

double mask_iou(const ImageGray& a, const ImageGray& b) {
  if (a.width != b.width || a.height != b.height) {
    throw LogicError(format("masks of %dx%d and %dx%d cannot be compared", a.width, a.height, b.width, b.height));
  }
  int64_t both = 0;
  int64_t any = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    both += is_person(a.pixels[i]) && is_person(b.pixels[i]);
    any += is_person(a.pixels[i]) || is_person(b.pixels[i]);
  }
  return any == 0 ? 1.0 : static_cast<double>(both) / static_cast<double>(any);
}

bool mask_has_person(const ImageGray& mask) {
  return std::any_of(mask.pixels.begin(), mask.pixels.end(), is_person);
}

}  // namespace livecap
