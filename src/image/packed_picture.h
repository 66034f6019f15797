// What the files of pictures hold: packed 8-bit channels.
#pragma once

#include <cstdint>
#include <vector>

namespace livecap {

struct PackedPicture {
  int width = 0;
  int height = 0;
  int channels = 0;             // 1 grey, 3 RGB, 4 RGBA
  std::vector<uint8_t> pixels;  // [channels*width*height] row major
};

// Throws IoError when a file says that it has more pixels than kMaxPicturePixels, which few bytes can say.
inline constexpr int64_t kMaxPicturePixels = int64_t{1} << 28;
void require_decodable(int64_t width, int64_t height);

}  // namespace livecap
