// PNG and JPEG files to and from packed images, and the number of threads of the image operations.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "base/image_rgb.h"

namespace livecap {

// 8-bit; a JPEG is turned as its EXIF data says; alpha is dropped, grey files become three equal channels. Throws
// IoError naming the file.
ImageRgb read_image_rgb(const std::filesystem::path& path);

// The same as luma.
ImageGray read_image_gray(const std::filesystem::path& path);

// Numbers of classes: of a PNG with a palette its indices, whatever colours they are shown in; else as read_image_gray,
// but grey of less than eight bits is not stretched to 255.
ImageGray read_image_labels(const std::filesystem::path& path);

// A mask as cutting tools leave it: the alpha of a picture that has one, unless it is the same everywhere; else as
// read_image_gray.
ImageGray read_image_mask(const std::filesystem::path& path);

// Width and height, not turned. Throws IoError naming the file.
std::pair<int, int> stored_picture_size(const std::filesystem::path& path);

// Through a temporary file and a rename. Throws IoError; LogicError when the pixels do not match the size.
void write_png(const ImageRgb& image, const std::filesystem::path& path);
void write_png(const ImageGray& image, const std::filesystem::path& path);
// With transparency: alpha has the same size (LogicError), colours are not multiplied by it.
void write_png(const ImageRgb& image, const ImageGray& alpha, const std::filesystem::path& path);

// The bytes of a file, for pictures inside another file. quality: 1..100. LogicError as above.
std::string encode_png(const ImageRgb& image);
std::string encode_jpeg(const ImageRgb& image, int quality = 88);

// While it lives, image operations of this process use n threads each (OpenCV's number, which is there again once the
// last of them has gone). A pipeline wants 1: its stages already have a thread each, and more would disturb the device
// that shares the cores.
class ImageThreads {
 public:
  explicit ImageThreads(int n);
  ~ImageThreads();
  ImageThreads(const ImageThreads&) = delete;
  ImageThreads& operator=(const ImageThreads&) = delete;
};

}  // namespace livecap
