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

}  // namespace livecap
