#include "image/image_io.h"

#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

cv::Mat decode(const std::filesystem::path& path, int flags) {
  if (std::filesystem::is_directory(path)) throw IoError(path.string() + ": is a folder, expected a PNG or JPEG file");
  const std::string bytes = read_file(path);
  if (bytes.empty()) throw IoError(path.string() + ": empty file, expected a PNG or JPEG picture");
  const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  cv::Mat image;
  try {
    image = cv::imdecode(raw, flags);
  } catch (const cv::Exception& e) {
    throw IoError(path.string() + ": cannot be decoded: " + e.err);
  }
  if (image.empty()) throw IoError(path.string() + ": not a readable PNG or JPEG picture");
  return image;
}

ImageGray to_gray(const cv::Mat& gray) {
  ImageGray image{gray.cols, gray.rows, std::vector<uint8_t>(size_t(gray.cols) * gray.rows)};
  cv::Mat copy(gray.rows, gray.cols, CV_8UC1, image.pixels.data());
  gray.copyTo(copy);
  return image;
}

std::string encode(const cv::Mat& image, const char* suffix, const std::vector<int>& parameters = {}) {
  std::vector<uint8_t> bytes;
  if (!cv::imencode(suffix, image, bytes, parameters)) throw IoError(format("%s: encoding failed", suffix));
  return {bytes.begin(), bytes.end()};
}

cv::Mat to_bgr(const ImageRgb& image, const char* where) {
  if (image.empty() || image.pixels.size() != size_t(3) * image.width * image.height)
    throw LogicError(format("%s: %zu bytes for %dx%d RGB", where, image.pixels.size(), image.width, image.height));
  const cv::Mat rgb(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

}  // namespace

ImageRgb read_image_rgb(const std::filesystem::path& path) {
  const cv::Mat bgr = decode(path, cv::IMREAD_COLOR);
  ImageRgb image{bgr.cols, bgr.rows, std::vector<uint8_t>(size_t(3) * bgr.cols * bgr.rows)};
  cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, image.pixels.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return image;
}

ImageGray read_image_gray(const std::filesystem::path& path) {
  return to_gray(decode(path, cv::IMREAD_GRAYSCALE));
}

ImageGray read_image_mask(const std::filesystem::path& path) {
  const cv::Mat stored = decode(path, cv::IMREAD_UNCHANGED);
  if (stored.type() != CV_8UC4) return read_image_gray(path);
  cv::Mat alpha;
  cv::extractChannel(stored, alpha, 3);
  double least, most;
  cv::minMaxLoc(alpha, &least, &most);
  return least < most ? to_gray(alpha) : read_image_gray(path);
}

void write_png(const ImageRgb& image, const std::filesystem::path& path) {
  write_file_atomically(path, encode(to_bgr(image, "write_png"), ".png"));
}

void write_png(const ImageGray& image, const std::filesystem::path& path) {
  if (image.empty() || image.pixels.size() != size_t(image.width) * image.height)
    throw LogicError(format("write_png: %zu bytes for %dx%d grey", image.pixels.size(), image.width, image.height));
  const cv::Mat gray(image.height, image.width, CV_8UC1, const_cast<uint8_t*>(image.pixels.data()));
  write_file_atomically(path, encode(gray, ".png"));
}

void write_png(const ImageRgb& image, const ImageGray& alpha, const std::filesystem::path& path) {
  if (alpha.width != image.width || alpha.height != image.height ||
      alpha.pixels.size() != size_t(alpha.width) * alpha.height)
    throw LogicError(
        format("write_png: alpha of %dx%d for %dx%d RGB", alpha.width, alpha.height, image.width, image.height));
  const cv::Mat channel(alpha.height, alpha.width, CV_8UC1, const_cast<uint8_t*>(alpha.pixels.data()));
  cv::Mat bgra;
  cv::merge(std::vector<cv::Mat>{to_bgr(image, "write_png"), channel}, bgra);
  write_file_atomically(path, encode(bgra, ".png"));
}

std::string encode_png(const ImageRgb& image) {
  return encode(to_bgr(image, "encode_png"), ".png");
}

std::string encode_jpeg(const ImageRgb& image, int quality) {
  return encode(to_bgr(image, "encode_jpeg"), ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
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
