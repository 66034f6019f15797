// Decoded FFmpeg pictures to packed RGB: colour matrix and range as tagged, chroma interpolated, then turned as the
// container's display matrix says.
#pragma once

#include <array>
#include <cstdint>

#include "base/image_rgb.h"

struct AVFrame;
struct SwsContext;

namespace livecap {

// How stored pixels map to shown ones: shown = M * stored with entries in {-1, 0, 1}, rows (x, y).
struct PixelTurn {
  std::array<int, 4> m = {1, 0, 0, 1};  // xx, xy, yx, yy
  bool is_identity() const { return m == std::array<int, 4>{1, 0, 0, 1}; }
  bool swaps_sides() const { return m[0] == 0; }
};

// From FFmpeg's 3x3 display matrix (nullptr: identity). Turns by anything but a multiple of 90 degrees are ignored.
PixelTurn pixel_turn(const int32_t* display_matrix);

class PictureConverter {
 public:
  PictureConverter() = default;
  ~PictureConverter();
  PictureConverter(const PictureConverter&) = delete;
  PictureConverter& operator=(const PictureConverter&) = delete;

  // width, height: of the result before the turn; pictures of another size are scaled to it. Throws IoError when the
  // pixel format cannot be converted.
  void convert(const AVFrame& frame, int width, int height, const PixelTurn& turn, ImageRgb& out);

 private:
  // With swscale, before the turn.
  void convert_any(const AVFrame& frame, int width, int height, ImageRgb& out);

  SwsContext* scaler_ = nullptr;
};

}  // namespace livecap
