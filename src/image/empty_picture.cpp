#include "image/empty_picture.h"

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {

ImageRgb read_empty_picture(const std::string& file, const VideoInfo& video) {
  ImageRgb picture = read_image_rgb(file);
  if (picture.width != video.width || picture.height != video.height)
    throw IoError(file + format(": the picture is %dx%d but the video is %dx%d", picture.width, picture.height,
                                video.width, video.height));
  return picture;
}

}  // namespace livecap
