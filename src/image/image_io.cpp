#include "image/image_io.h"

#include <algorithm>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "image/exif_orientation.h"
#include "image/jpeg_file.h"
#include "image/png_file.h"
#include "livecap/error.h"

namespace livecap {
namespace {

cv::Mat mat(PackedPicture& picture) {
  return {picture.height, picture.width, CV_8UC(picture.channels), picture.pixels.data()};
}

// As it is to be viewed; orientation: of exif_orientation(), what to do to what is stored.
PackedPicture upright(PackedPicture stored, int orientation) {
  if (orientation == 1) return stored;
  cv::Mat turned = mat(stored);
  if (orientation >= 5) turned = turned.t();
  constexpr int kMirrorX = 1, kMirrorY = 0, kBoth = -1;
  switch (orientation) {
    case 2:
    case 6:
      cv::flip(turned, turned, kMirrorX);
      break;
    case 3:
    case 7:
      cv::flip(turned, turned, kBoth);
      break;
    case 4:
    case 8:
      cv::flip(turned, turned, kMirrorY);
      break;
  }
  return {turned.cols, turned.rows, stored.channels, {turned.datastart, turned.dataend}};
}

// What `of_png` or `of_jpeg` makes of the file's bytes. Throws IoError naming the file.
template <typename OfPng, typename OfJpeg>
auto decoded(const std::filesystem::path& path, OfPng of_png, OfJpeg of_jpeg) {
  if (std::filesystem::is_directory(path)) throw IoError(path.string() + ": is a folder, expected a PNG or JPEG file");
  const std::string bytes = read_file(path);
  if (bytes.empty()) throw IoError(path.string() + ": empty file, expected a PNG or JPEG picture");
  const bool jpeg = is_jpeg(bytes);
  if (!jpeg && !is_png(bytes)) throw IoError(path.string() + ": not a PNG or JPEG picture");
  try {
    return jpeg ? of_jpeg(bytes) : of_png(bytes);
  } catch (const IoError& error) {
    throw IoError(path.string() + ": not a readable " + (jpeg ? "JPEG" : "PNG") + " picture: " + error.what());
  }
}

// channels: of a JPEG, 1 or 3; a PNG keeps its own.
PackedPicture decode(const std::filesystem::path& path, int channels,
                     PackedPicture (*of_png)(std::string_view) = decode_png) {
  return decoded(path, of_png, [channels](const std::string& bytes) {
    return upright(decode_jpeg(bytes, channels), exif_orientation(bytes));
  });
}

ImageGray to_gray(PackedPicture picture) {
  if (picture.channels == 1) return {picture.width, picture.height, std::move(picture.pixels)};
  ImageGray image{picture.width, picture.height, std::vector<uint8_t>(size_t(picture.width) * picture.height)};
  cv::Mat gray(image.height, image.width, CV_8UC1, image.pixels.data());
  cv::cvtColor(mat(picture), gray, picture.channels == 3 ? cv::COLOR_RGB2GRAY : cv::COLOR_RGBA2GRAY);
  return image;
}

void require_size(size_t n_bytes, size_t channels, int width, int height, const char* where) {
  if (n_bytes == 0 || n_bytes != channels * width * height)
    throw LogicError(format("%s: %zu bytes for %dx%d pixels of %zu", where, n_bytes, width, height, channels));
}

std::string encoded(const ImageRgb& image, const char* where) {
  require_size(image.pixels.size(), 3, image.width, image.height, where);
  return encode_png(image.pixels.data(), image.width, image.height, 3);
}

}  // namespace

ImageRgb read_image_rgb(const std::filesystem::path& path) {
  PackedPicture picture = decode(path, 3);
  if (picture.channels == 3) return {picture.width, picture.height, std::move(picture.pixels)};
  ImageRgb image{picture.width, picture.height, std::vector<uint8_t>(size_t(3) * picture.width * picture.height)};
  cv::Mat rgb(image.height, image.width, CV_8UC3, image.pixels.data());
  cv::cvtColor(mat(picture), rgb, picture.channels == 1 ? cv::COLOR_GRAY2RGB : cv::COLOR_RGBA2RGB);
  return image;
}

ImageGray read_image_gray(const std::filesystem::path& path) {
  return to_gray(decode(path, 1));
}

ImageGray read_image_labels(const std::filesystem::path& path) {
  return to_gray(decode(path, 1, decode_png_numbers));
}

ImageGray read_image_mask(const std::filesystem::path& path) {
  PackedPicture stored = decode(path, 1);
  if (stored.channels != 4) return to_gray(std::move(stored));
  ImageGray alpha{stored.width, stored.height, {}};
  for (size_t i = 3; i < stored.pixels.size(); i += 4) alpha.pixels.push_back(stored.pixels[i]);
  const auto [least, most] = std::minmax_element(alpha.pixels.begin(), alpha.pixels.end());
  return *least < *most ? alpha : to_gray(std::move(stored));
}

std::pair<int, int> stored_picture_size(const std::filesystem::path& path) {
  return decoded(path, png_size, jpeg_size);
}

void write_png(const ImageRgb& image, const std::filesystem::path& path) {
  write_file_atomically(path, encoded(image, "write_png"));
}

void write_png(const ImageGray& image, const std::filesystem::path& path) {
  require_size(image.pixels.size(), 1, image.width, image.height, "write_png");
  write_file_atomically(path, encode_png(image.pixels.data(), image.width, image.height, 1));
}

void write_png(const ImageRgb& image, const ImageGray& alpha, const std::filesystem::path& path) {
  require_size(image.pixels.size(), 3, image.width, image.height, "write_png");
  require_size(alpha.pixels.size(), 1, alpha.width, alpha.height, "write_png, alpha");
  if (alpha.width != image.width || alpha.height != image.height)
    throw LogicError(
        format("write_png: alpha of %dx%d for %dx%d RGB", alpha.width, alpha.height, image.width, image.height));
  std::vector<uint8_t> rgba;
  rgba.reserve(4 * alpha.pixels.size());
  for (size_t i = 0; i < alpha.pixels.size(); ++i) {
    rgba.insert(rgba.end(), &image.pixels[3 * i], &image.pixels[3 * i] + 3);
    rgba.push_back(alpha.pixels[i]);
  }
  write_file_atomically(path, encode_png(rgba.data(), image.width, image.height, 4));
}

std::string encode_png(const ImageRgb& image) {
  return encoded(image, "encode_png");
}

std::string encode_jpeg(const ImageRgb& image, int quality) {
  require_size(image.pixels.size(), 3, image.width, image.height, "encode_jpeg");
  return encode_jpeg(image.pixels.data(), image.width, image.height, quality);
}

namespace {

struct ThreadNumber {
  std::mutex mutex;
  int users = 0;
  int before = 0;
};

ThreadNumber& thread_number() {
  static ThreadNumber number;
  return number;
}

}  // namespace

ImageThreads::ImageThreads(int n) {
  ThreadNumber& number = thread_number();
  std::lock_guard lock(number.mutex);
  if (number.users++ == 0) number.before = cv::getNumThreads();
  cv::setNumThreads(n);
}

ImageThreads::~ImageThreads() {
  ThreadNumber& number = thread_number();
  std::lock_guard lock(number.mutex);
  if (--number.users == 0) cv::setNumThreads(number.before);
}

}  // namespace livecap
