// Phones store pictures as the sensor saw them and note in the EXIF data how to turn them for viewing.
#pragma once

#include <string_view>

namespace livecap {

// The tag "orientation" (1..8; 1 = as stored, 6 = a quarter turn clockwise) of the bytes of a JPEG file; 1 when there
// is none and for other files.
int exif_orientation(std::string_view jpeg);

// Clockwise quarter turns (0..3) of an orientation; 0 for mirrored pictures.
int quarter_turns(int orientation);

}  // namespace livecap
