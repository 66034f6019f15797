#include "image/empty_picture.h"

#include <utility>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {
namespace {

ImageRgb read_empty_picture(const std::string& file, const VideoInfo& video) {
  ImageRgb picture = read_image_rgb(file);
  if (picture.width != video.width || picture.height != video.height)
    throw IoError(file + format(": the picture is %dx%d but the video is %dx%d", picture.width, picture.height,
                                video.width, video.height));
  return picture;
}

}  // namespace

std::vector<ImageRgb> read_empty_pictures(const std::string& background, int n_frames, const std::string& video,
                                          VideoReader& reader) {
  std::vector<ImageRgb> pictures;
  if (!background.empty()) pictures.push_back(read_empty_picture(background, reader.info()));
  if (n_frames <= 0) return pictures;
  const auto require_more_than = [&](int64_t n) {
    if (n_frames >= n)
      throw ConfigError(format("--background-frames %d: %s has %lld frames, and some must show the person", n_frames,
                               video.c_str(), static_cast<long long>(n)));
  };
  if (const int64_t hint = reader.info().frame_count_hint; hint >= 0) require_more_than(hint);
  Frame frame;
  for (int i = 0; i < n_frames; ++i) {
    if (!reader.read(frame)) require_more_than(i);
    if (!frame.damaged) pictures.push_back(std::move(frame.image));
  }
  if (pictures.empty()) throw IoError(video + ": none of the background frames could be decoded");
  return pictures;
}

std::string not_empty_warning(const std::string& video, int n_person, int n_frames) {
  return video + format(
                     ": the network sees a person in %d of the first %d frames, which --background-frames takes for "
                     "the empty scene",
                     n_person, n_frames);
}

}  // namespace livecap
