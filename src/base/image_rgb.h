// Colour and mask images as packed bytes: what crosses between rooms that do not know OpenCV.
#pragma once

#include <cstdint>
#include <vector>

namespace livecap {

struct ImageRgb {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;  // [3*width*height] R,G,B, row major
  bool empty() const { return pixels.empty(); }
};

struct ImageGray {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;  // [width*height] row major
  bool empty() const { return pixels.empty(); }
};

}  // namespace livecap
