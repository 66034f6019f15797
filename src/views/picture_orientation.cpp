#include "views/picture_orientation.h"

#include <cstdint>
#include <string>
#include <string_view>

#include "base/text.h"

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

// The value of the tag "orientation" (1..8), 1 when there is none.
uint32_t orientation(const Tiff& tiff) {
  constexpr uint32_t kOrientationTag = 0x0112;
  const size_t directory = tiff.number(4, 4);
  const uint32_t n = tiff.number(directory, 2);
  for (uint32_t i = 0; i < n; ++i)
    if (const size_t entry = directory + 2 + 12 * size_t(i); tiff.number(entry, 2) == kOrientationTag)
      return tiff.number(entry + 8, 2);
  return 1;
}

}  // namespace

int quarter_turns(const std::filesystem::path& picture) {
  const std::string bytes = read_file(picture);
  if (bytes.rfind("\xff\xd8", 0) != 0) return 0;  // no JPEG
  const auto byte = [&](size_t i) { return i < bytes.size() ? static_cast<uint8_t>(bytes[i]) : 0u; };
  // The segments before the picture's data.
  for (size_t at = 2; byte(at) == 0xff && byte(at + 1) != 0xda && at + 4 < bytes.size();) {
    const size_t size = byte(at + 2) << 8 | byte(at + 3);
    if (byte(at + 1) == 0xe1 && bytes.compare(at + 4, 6, std::string("Exif\0\0", 6)) == 0 && size > 8) {
      switch (orientation(Tiff(std::string_view(bytes).substr(at + 10, size - 8)))) {
        case 6:
          return 1;
        case 3:
          return 2;
        case 8:
          return 3;
        default:
          return 0;
      }
    }
    at += 2 + size;
  }
  return 0;
}

ViewPose turned(const ViewPose& view, int quarter_turns) {
  ViewPose result = view;
  for (int i = 0; i < quarter_turns; ++i) {
    // Pixel (u, v) goes to (height - 1 - v, u), so the camera's axes turn: x' = -y, y' = x.
    const Camera from = result.camera;
    Camera& to = result.camera;
    to.width = from.height, to.height = from.width;
    to.fx = from.fy, to.fy = from.fx;
    to.cx = from.height - 1 - from.cy, to.cy = from.cx;
    // (p2, p1) is a direction in the picture and turns with it.
    to.distortion[3] = -from.distortion[2];  // p2' = -p1
    to.distortion[2] = from.distortion[3];   // p1' = p2
    Eigen::Matrix3d turn;
    turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    result.camera_from_world = Eigen::Isometry3d(turn) * result.camera_from_world;
  }
  return result;
}

}  // namespace livecap
