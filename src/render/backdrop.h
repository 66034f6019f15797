// What is behind the person.
#pragma once

#include <optional>
#include <string>

#include "base/image_rgb.h"
#include "picture/color_scale.h"
#include "render/options.h"

namespace livecap::render {

// width x height of one colour.
ImageRgb plain_picture(int width, int height, const Rgb& color);

// As large as there is room for, bars at the sides.
ImageRgb fitted_picture(const ImageRgb& image, int width, int height);

class Backdrop {
 public:
  // options: background of RenderOptions. Throws ConfigError for a text that is neither colour nor file, IoError for a
  // file that is no picture.
  Backdrop(const RenderOptions& options, int width, int height);

  // video: the undistorted picture of this frame, used where it was asked for.
  ImageRgb picture(const ImageRgb& video) const;
  bool is_transparent() const { return transparent_; }

 private:
  int width_, height_;
  bool video_ = false;
  bool transparent_ = false;
  ImageRgb still_;
};

}  // namespace livecap::render
