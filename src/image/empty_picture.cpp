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

void read_empty_pictures(const std::string& background, int n_frames, const std::string& video, VideoReader& reader,
                         const std::function<void(ImageRgb&&)>& take) {
  if (!background.empty()) take(read_empty_picture(background, reader.info()));
  if (n_frames <= 0) return;
  const auto require_more_than = [&](int64_t n) {
    if (n_frames >= n)
      throw ConfigError(format("--background-frames %d: %s has %lld frames, and some must show the person", n_frames,
                               video.c_str(), static_cast<long long>(n)));
  };
  if (const int64_t hint = reader.info().frame_count_hint; hint >= 0) require_more_than(hint);
  Frame frame;
  bool any = !background.empty();
  for (int i = 0; i < n_frames; ++i) {
    if (!reader.read(frame)) require_more_than(i);
    if (frame.damaged) continue;
    take(std::move(frame.image));
    any = true;
  }
  if (!any) throw IoError(video + ": none of the background frames could be decoded");
}

std::string not_empty_warning(const std::string& video, int n_person, int n_frames) {
  return video + format(
                     ": the network sees a person in %d of the first %d frames, which --background-frames takes for "
                     "the empty scene",
                     n_person, n_frames);
}

}  // namespace livecap
