#include "image/packed_picture.h"

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

void require_decodable(int64_t width, int64_t height) {
  if (width * height > kMaxPicturePixels)
    throw IoError(format("%lld x %lld, more than %lld pixels", static_cast<long long>(width),
                         static_cast<long long>(height), static_cast<long long>(kMaxPicturePixels)));
}

}  // namespace livecap
