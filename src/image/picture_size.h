// How large the pictures of a capture may be.
#pragma once

#include <string>

#include "base/value_range.h"

namespace livecap {

// Squares of distances in larger ones do not fit into 32 bits; nothing halves the side of smaller ones.
inline constexpr ValueRange kPictureSidePx{2, 16000};

// what: whose pictures. Throws ConfigError.
void require_picture_size(const std::string& what, int width, int height);

}  // namespace livecap
