// Pictures of the empty scene that goes with a video.
#pragma once

#include <functional>
#include <string>

#include "base/image_rgb.h"
#include "image/video.h"

namespace livecap {

// Gives `take` one after the other, as they are in the files: the picture `background`, or the first n_frames of
// `video`, which reader is at the start of; none when neither is given. Throws IoError when the picture cannot be read
// or is not of the video's size, or no frame could be decoded; ConfigError when n_frames are all that the video has.
void read_empty_pictures(const std::string& background, int n_frames, const std::string& video, VideoReader& reader,
                         const std::function<void(ImageRgb&&)>& take);

// What to warn of when the network sees somebody in n_person of those frames.
std::string not_empty_warning(const std::string& video, int n_person, int n_frames);

}  // namespace livecap
