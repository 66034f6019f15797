// Phones store pictures as the sensor saw them and note in the EXIF data how to turn them. Readers of pictures turn
// them; COLMAP does not, so its cameras are those of the stored picture.
#pragma once

#include <filesystem>

#include "views/camera_files.h"

namespace livecap {

// Clockwise quarter turns (0..3) by which a stored JPEG is turned for viewing; 0 without EXIF data, for other files,
// and for mirrored pictures. Throws IoError when the file cannot be read.
int quarter_turns(const std::filesystem::path& picture);

// The camera of the picture after that many clockwise quarter turns, distortion included.
ViewPose turned(const ViewPose& view, int quarter_turns);

}  // namespace livecap
