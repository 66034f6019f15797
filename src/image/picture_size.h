// How large the pictures of a capture may be.
#pragma once

#include <string>

#include "base/value_range.h"

namespace livecap {

// The distance field counts pixels in 15 bits; a side of one pixel cannot be halved.
inline constexpr ValueRange kPictureSidePx{2, 16000};

// what: whose pictures. Throws ConfigError.
void require_picture_size(const std::string& what, int width, int height);

}  // namespace livecap
