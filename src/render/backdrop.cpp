#include "render/backdrop.h"

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "render/viewpoint.h"

namespace livecap::render {
namespace {

constexpr Rgb kBar = {0, 0, 0};
constexpr Rgb kStudioTop = {238, 239, 241}, kStudioBottom = {206, 208, 212};

ImageRgb studio(int width, int height) {
  ImageRgb image = plain_picture(width, height, kStudioTop);
  for (int y = 0; y < height; ++y) {
    const float share = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < 3; ++k)
        image.pixels[3 * (size_t(y) * width + x) + k] =
            static_cast<uint8_t>(kStudioTop[k] + share * (kStudioBottom[k] - kStudioTop[k]) + 0.5f);
    }
  }
  return image;
}

// "#rrggbb".
std::optional<Rgb> parsed_color(const std::string& text) {
  if (text.size() != 7 || text[0] != '#' || text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    return std::nullopt;
  const unsigned long value = std::strtoul(text.c_str() + 1, nullptr, 16);
  return Rgb{static_cast<float>(value >> 16), static_cast<float>(value >> 8 & 255), static_cast<float>(value & 255)};
}

}  // namespace

ImageRgb plain_picture(int width, int height, const Rgb& color) {
  ImageRgb image{width, height, std::vector<uint8_t>(size_t(3) * width * height)};
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<uint8_t>(color[i % 3]);
  return image;
}

ImageRgb fitted_picture(const ImageRgb& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  const FittedBox box = fitted_box(image.width, image.height, width, height);
  ImageRgb out = plain_picture(width, height, kBar);
  const cv::Mat from(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data()));
  cv::Mat to(height, width, CV_8UC3, out.pixels.data());
  cv::resize(from, to(cv::Rect(box.left, box.top, box.width, box.height)), cv::Size(box.width, box.height), 0, 0,
             box.width < image.width ? cv::INTER_AREA : cv::INTER_LINEAR);
  return out;
}

Backdrop::Backdrop(const RenderOptions& options, int width, int height) : width_(width), height_(height) {
  const std::string& background = options.background;
  video_ = background == "video" || (background.empty() && !options.is_about_person());
  transparent_ = background == "none";
  if (video_ || transparent_) return;
  std::error_code ignored;
  if (background.empty()) {
    still_ = studio(width, height);
  } else if (const std::optional<Rgb> color = parsed_color(background)) {
    still_ = plain_picture(width, height, *color);
  } else if (std::filesystem::exists(background, ignored)) {
    still_ = fitted_picture(read_image_rgb(background), width, height);
  } else {
    throw ConfigError("--background " + background + ": expected video, none, #rrggbb or a picture file");
  }
}

ImageRgb Backdrop::picture(const ImageRgb& video) const {
  if (!video_) return still_;
  return fitted_picture(video, width_, height_);
}

}  // namespace livecap::render
