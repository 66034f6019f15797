#include "image/exif_orientation.h"

#include <cstdint>

namespace livecap {
namespace {

// Bytes of a TIFF block, whose numbers may be of either byte order; 0 beyond the end.
class Tiff {
 public:
  explicit Tiff(std::string_view bytes) : bytes_(bytes), little_(bytes.substr(0, 2) == "II") {}
  uint32_t number(size_t at, int size) const {
    uint32_t value = 0;
    for (int k = 0; k < size; ++k) {
      const size_t i = at + (little_ ? size - 1 - k : k);
      value = value << 8 | (i < bytes_.size() ? static_cast<uint8_t>(bytes_[i]) : 0);
    }
    return value;
  }

 private:
  std::string_view bytes_;
  bool little_;
};

int orientation_of(const Tiff& tiff) {
  constexpr uint32_t kOrientationTag = 0x0112;
  const size_t directory = tiff.number(4, 4);
  const uint32_t n = tiff.number(directory, 2);
  for (uint32_t i = 0; i < n; ++i)
    if (const size_t entry = directory + 2 + 12 * size_t(i); tiff.number(entry, 2) == kOrientationTag) {
      const uint32_t value = tiff.number(entry + 8, 2);
      return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
    }
  return 1;
}

}  // namespace

int exif_orientation(std::string_view jpeg) {
  if (!jpeg.starts_with("\xff\xd8")) return 1;
  const auto byte = [&](size_t i) { return i < jpeg.size() ? static_cast<uint8_t>(jpeg[i]) : 0u; };
  // The segments before the picture's data.
  for (size_t at = 2; byte(at) == 0xff && byte(at + 1) != 0xda && at + 4 < jpeg.size();) {
    const size_t size = byte(at + 2) << 8 | byte(at + 3);
    if (byte(at + 1) == 0xe1 && jpeg.substr(at + 4).starts_with(std::string_view("Exif\0\0", 6)) && size > 8)
      return orientation_of(Tiff(jpeg.substr(at + 10, size - 8)));
    at += 2 + size;
  }
  return 1;
}

int quarter_turns(int orientation) {
  return orientation == 6 ? 1 : orientation == 3 ? 2 : orientation == 8 ? 3 : 0;
}

}  // namespace livecap
