#include "picture/resample.h"

#include <cstddef>

namespace livecap {

ImageRgb repeated(const ImageRgb& image, int n) {
  ImageRgb large{image.width * n, image.height * n, {}};
  large.pixels.resize(std::size_t(3) * large.width * large.height);
  uint8_t* to = large.pixels.data();
  for (int y = 0; y < large.height; ++y) {
    const uint8_t* from = &image.pixels[std::size_t(3) * (y / n) * image.width];
    for (int x = 0; x < image.width; ++x, from += 3) {
      for (int i = 0; i < n; ++i) {
        for (int k = 0; k < 3; ++k) *to++ = from[k];
      }
    }
  }
  return large;
}

ImageRgb averaged(const ImageRgb& image, int n) {
  ImageRgb small{image.width / n, image.height / n, {}};
  small.pixels.resize(std::size_t(3) * small.width * small.height);
  uint8_t* to = small.pixels.data();
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      int sum[3] = {};
      for (int row = 0; row < n; ++row) {
        const uint8_t* from = &image.pixels[3 * (std::size_t(n * y + row) * image.width + std::size_t(n) * x)];
        for (int i = 0; i < 3 * n; ++i) sum[i % 3] += from[i];
      }
      for (int k = 0; k < 3; ++k) *to++ = static_cast<uint8_t>((sum[k] + n * n / 2) / (n * n));
    }
  }
  return small;
}

}  // namespace livecap
