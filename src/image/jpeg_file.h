// JPEG files as bytes. Errors do not name the file: its bytes do not know.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "image/packed_picture.h"

namespace livecap {

bool is_jpeg(std::string_view bytes);

// Width and height as stored. Throws IoError.
std::pair<int, int> jpeg_size(std::string_view bytes);

// channels: 1 for the luma, 3 for RGB. As stored: not turned as the EXIF data says. Throws IoError: damaged, cut off,
// too large.
PackedPicture decode_jpeg(std::string_view bytes, int channels);

// rgb: [3*width*height]; quality: 1..100. Throws IoError.
std::string encode_jpeg(const uint8_t* rgb, int width, int height, int quality);

}  // namespace livecap
