// PNG files as bytes. Errors do not name the file: its bytes do not know.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "image/packed_picture.h"

namespace livecap {

bool is_png(std::string_view bytes);

// Width and height. Throws IoError.
std::pair<int, int> png_size(std::string_view bytes);

// 8-bit whatever the file has; a palette becomes RGB, transparency RGBA. Gamma is not applied: labels and masks are
// numbers. Throws IoError: damaged, cut off, or too large.
PackedPicture decode_png(std::string_view bytes);

// The same, but of a palette, or of grey with less than eight bits, the numbers that the file holds: one channel.
PackedPicture decode_png_numbers(std::string_view bytes);

// pixels: [channels*width*height]; channels as in PackedPicture. Throws IoError.
std::string encode_png(const uint8_t* pixels, int width, int height, int channels);

}  // namespace livecap
