#include "image/picture_size.h"

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

void require_picture_size(const std::string& what, int width, int height) {
  if (kPictureSidePx.contains(width) && kPictureSidePx.contains(height)) return;
  throw ConfigError(what + format(": pictures of %dx%d; they must have %g to %g px a side", width, height,
                                  kPictureSidePx.least, kPictureSidePx.most));
}

}  // namespace livecap
