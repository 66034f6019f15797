#include "image/image_io.h"

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/scratch_folder.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

class ImageIo : public testing::Test {
 protected:
  ImageIo() : path_(scratch_ / "picture") {}

  void hold(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }

  // What `read` says of the file, which it must refuse.
  template <typename Read>
  std::string refused(Read read) {
    try {
      read(path_);
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find(path_.string()), std::string::npos) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "accepted";
    return {};
  }

  ScratchFolder scratch_;
  std::filesystem::path path_;
};

// Every pixel differs from its neighbours, and values use the whole range.
cv::Mat pattern(int type) {
  cv::Mat image(7, 11, type);
  const double one = image.depth() == CV_16U ? 65535 : 255;
  const int n = image.cols * image.channels();
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < n; ++x) {
      const double value = one * ((37 * x + 101 * y) % 241) / 240;  // of 16 bits the lower ones differ from the upper
      if (image.depth() == CV_16U)
        image.ptr<uint16_t>(y)[x] = static_cast<uint16_t>(value);
      else
        image.ptr<uint8_t>(y)[x] = static_cast<uint8_t>(value);
    }
  return image;
}

std::string encoded(const char* suffix, const cv::Mat& image, const std::vector<int>& options = {}) {
  std::vector<uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(suffix, image, bytes, options));
  return {bytes.begin(), bytes.end()};
}

// A JPEG with the EXIF tag "orientation".
std::string oriented(const std::string& jpeg, int orientation) {
  std::string exif(
      "\xff\xe1\0\x22"
      "Exif\0\0MM\0*\0\0\0\10\0\1\1\22\0\3\0\0\0\1\0",
      4 + 6 + 8 + 2 + 9);
  exif += static_cast<char>(orientation);
  exif += std::string("\0\0\0\0\0\0", 6);
  return jpeg.substr(0, 2) + exif + jpeg.substr(2);
}

// The largest difference between what is read and what OpenCV reads.
int differs_from_opencv(const std::filesystem::path& path) {
  const cv::Mat bgr = cv::imread(path.string(), cv::IMREAD_COLOR),
                gray = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
  const ImageRgb image = read_image_rgb(path);
  const ImageGray luma = read_image_gray(path);
  EXPECT_EQ(cv::Size(image.width, image.height), bgr.size());
  EXPECT_EQ(cv::Size(luma.width, luma.height), bgr.size());
  int most = 0;
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; ++x) {
      const size_t i = size_t(y) * bgr.cols + x;
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(image.pixels[3 * i + c] - bgr.at<cv::Vec3b>(y, x)[2 - c]));
      most = std::max(most, std::abs(luma.pixels[i] - gray.at<uint8_t>(y, x)));
    }
  return most;
}

TEST_F(ImageIo, PngIsReadAsOpenCvReadsIt) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}) {
    hold(encoded(".png", pattern(type)));
    EXPECT_LE(differs_from_opencv(path_), 1) << "type " << type;
  }
  hold(encoded(".png", pattern(CV_8UC1), {cv::IMWRITE_PNG_BILEVEL, 1}));
  EXPECT_EQ(differs_from_opencv(path_), 0);
}

TEST_F(ImageIo, JpegIsReadAsOpenCvReadsIt) {
  cv::Mat smooth;
  cv::resize(pattern(CV_8UC3), smooth, {64, 40}, 0, 0, cv::INTER_CUBIC);
  const std::string jpeg = encoded(".jpg", smooth);
  hold(jpeg);
  EXPECT_LE(differs_from_opencv(path_), 1);
  hold(encoded(".jpg", smooth, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}));
  EXPECT_LE(differs_from_opencv(path_), 1);
  hold(encoded(".jpg", pattern(CV_8UC1)));
  EXPECT_LE(differs_from_opencv(path_), 1);
  for (int orientation = 0; orientation <= 9; ++orientation) {
    hold(oriented(jpeg, orientation));
    EXPECT_LE(differs_from_opencv(path_), 1) << "orientation " << orientation;
    EXPECT_EQ(stored_picture_size(path_), (std::pair{64, 40}));
  }
  // A camera's bytes between two segments are no reason to refuse its picture.
  const size_t second = 4 + static_cast<uint8_t>(jpeg[4]) * 256 + static_cast<uint8_t>(jpeg[5]);
  for (const size_t at : {second, jpeg.size() - 2}) {
    hold(jpeg.substr(0, at) + "..." + jpeg.substr(at));
    EXPECT_LE(differs_from_opencv(path_), 1) << at;
    // What else is wrong is not forgotten for it.
    hold(jpeg.substr(0, second) + "..." + jpeg.substr(second, jpeg.size() / 2));
    refused([](const std::filesystem::path& path) { read_image_rgb(path); });
  }
}

std::string bytes(const std::string& hex) {
  std::string result;
  for (size_t i = 0; i < hex.size(); i += 2) result += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return result;
}

// Two bits a pixel: (10 20 30), (200 100 50), (0 255 0), (9 8 7), and there and back; in the second green is
// transparent.
TEST_F(ImageIo, PalettesAreColours) {
  const std::vector<uint8_t> expected = {10, 20, 30, 200, 100, 50, 0,   255, 0,  9,  8,  7,
                                         9,  8,  7,  0,   255, 0,  200, 100, 50, 10, 20, 30};
  hold(
      bytes("89504e470d0a1a0a0000000d494844520000000400000002020300000002c695f00000000c504c54450a141ec8643200"
            "ff0009080703dc81270000000c49444154789c639066780200013901004564919b0000000049454e44ae426082"));
  EXPECT_EQ(read_image_rgb(path_).pixels, expected);
  hold(
      bytes("89504e470d0a1a0a0000000d494844520000000400000002020300000002c695f00000000c504c54450a141ec8643200"
            "ff0009080703dc81270000000374524e53ffff00d7ca0d410000000c49444154789c639066780200013901004564919b"
            "0000000049454e44ae426082"));
  EXPECT_EQ(read_image_rgb(path_).pixels, expected);
  EXPECT_EQ(read_image_mask(path_).pixels, (std::vector<uint8_t>{255, 255, 0, 255, 255, 0, 255, 255}));
}

// 5 x 5 pixels, pixel (x, y) is 5 x + 3 y of what its bits can hold: of 1, 2, 4 and 8 bits of a palette, two of them
// interlaced, then of grey.
TEST_F(ImageIo, LabelsAreTheIndicesOfAPalette) {
  const std::pair<int, const char*> files[] = {
      {1,
       "89504e470d0a1a0a0000000d4948445200000005000000050103000000b7a1b4a600000006504c54450b30557a9fc4a1"
       "e473e00000000e4944415478da63086058c100c6000b4a0241d09f44c20000000049454e44ae426082"},
      {2,
       "89504e470d0a1a0a0000000d49484452000000050000000502030000018706fee00000000c504c54450b30557a9fc4e9"
       "0e33587da23450d8150000001a4944415478da636000830620ec602860b800c4c70e30e43800002e26056b51de3d0000"
       "00000049454e44ae426082"},
      {4,
       "89504e470d0a1a0a0000000d49484452000000050000000504030000007f413bd600000030504c54450b30557a9fc4e9"
       "0e33587da2c7ec11365b80a5caef14395e83a8cdf2173c6186abd0f51a3f6489aed3f81d42678cb1d657d12d3c000000"
       "1c4944415478da63605defc06071a980219b7501c33c8b0b0c07b319003cab0651d29da2350000000049454e44ae4260"
       "82"},
      {4,
       "89504e470d0a1a0a0000000d494844520000000500000005040300000108460b4000000030504c54450b30557a9fc4e9"
       "0e33587da2c7ec11365b80a5caef14395e83a8cdf2173c6186abd0f51a3f6489aed3f81d42678cb1d657d12d3c000000"
       "244944415478da636060706038c0b0802181216101433cc3560669068b4b050cf32c2e000052860750b7eed0ed000000"
       "0049454e44ae426082"},
      {8,
       "89504e470d0a1a0a0000000d4948445200000005000000050803000000bab1d6d700000060504c54450b30557a9fc4e9"
       "0e33587da2c7ec11365b80a5caef14395e83a8cdf2173c6186abd0f51a3f6489aed3f81d42678cb1d6fb20456a8fb4d9"
       "fe23486d92b7dc01264b7095badf04294e7398bde2072c51769bc0e50a2f54799ec3e80d32577ca1c6b86ffdb8000000"
       "264944415478da636060e5e2176160e6e015126760e316109562e0e413969065e011149356000013100191c19425dc00"
       "00000049454e44ae426082"},
      {4,
       "89504e470d0a1a0a0000000d49484452000000050000000504000000006df494380000001c4944415478da63605defc0"
       "6071a980219b7501c33c8b0b0c07b319003cab0651d29da2350000000049454e44ae426082"}};
  for (const auto& [bits, hex] : files) {
    hold(bytes(hex));
    const ImageGray labels = read_image_labels(path_);
    ASSERT_EQ(labels.pixels.size(), 25u);
    for (int i = 0; i < 25; ++i)
      EXPECT_EQ(labels.pixels[i], (5 * (i % 5) + 3 * (i / 5)) % (1 << bits)) << bits << " bits, pixel " << i;
  }
  for (int i = 0; i < 25; ++i) EXPECT_EQ(read_image_gray(path_).pixels[i], read_image_labels(path_).pixels[i] * 17);
  // What has neither is grey.
  const ImageGray gray{2, 1, {5, 19}};
  write_png(gray, path_);
  EXPECT_EQ(read_image_labels(path_).pixels, gray.pixels);
  hold(encoded(".png", pattern(CV_8UC3)));
  EXPECT_EQ(read_image_labels(path_).pixels, read_image_gray(path_).pixels);
  hold(bytes(files[2].second).substr(0, 100));
  refused([](const std::filesystem::path& path) { read_image_labels(path); });
}

TEST_F(ImageIo, PngKeepsEveryByte) {
  ImageRgb rgb{5, 3, {}};
  ImageGray gray{5, 3, {}};
  for (int i = 0; i < 45; ++i) rgb.pixels.push_back(static_cast<uint8_t>(i * 37));
  for (int i = 0; i < 15; ++i) gray.pixels.push_back(static_cast<uint8_t>(i * 17));
  write_png(rgb, path_);
  EXPECT_EQ(read_image_rgb(path_).pixels, rgb.pixels);
  EXPECT_EQ(read_image_rgb(path_).width, 5);
  EXPECT_EQ(stored_picture_size(path_), (std::pair{5, 3}));
  EXPECT_LE(differs_from_opencv(path_), 1);  // by its luma
  write_png(gray, path_);
  EXPECT_EQ(read_image_gray(path_).pixels, gray.pixels);
  EXPECT_EQ(read_image_mask(path_).pixels, gray.pixels);
  EXPECT_LE(differs_from_opencv(path_), 1);  // by its luma
  const ImageRgb as_rgb = read_image_rgb(path_);
  for (int i = 0; i < 45; ++i) EXPECT_EQ(as_rgb.pixels[i], gray.pixels[i / 3]);
  write_png(rgb, gray, path_);
  EXPECT_EQ(read_image_rgb(path_).pixels, rgb.pixels);
  EXPECT_EQ(read_image_mask(path_).pixels, gray.pixels);
  EXPECT_LE(differs_from_opencv(path_), 1);  // by its luma
}

TEST_F(ImageIo, AMaskWithoutHolesInItsAlphaIsItsLuma) {
  const ImageRgb rgb{2, 1, {255, 255, 255, 0, 0, 0}};
  write_png(rgb, ImageGray{2, 1, {255, 255}}, path_);
  EXPECT_EQ(read_image_mask(path_).pixels, (std::vector<uint8_t>{255, 0}));
}

TEST_F(ImageIo, JpegIsWhatOpenCvReadsOfIt) {
  cv::Mat smooth;
  cv::resize(pattern(CV_8UC3), smooth, {64, 40}, 0, 0, cv::INTER_CUBIC);
  hold(encoded(".png", smooth));
  const ImageRgb image = read_image_rgb(path_);
  hold(encode_jpeg(image, 97));
  EXPECT_LE(differs_from_opencv(path_), 1);
  EXPECT_GT(cv::PSNR(smooth, cv::imread(path_.string())), 30);
}

TEST_F(ImageIo, BadFilesAreNamed) {
  const auto rgb = [](const std::filesystem::path& path) { read_image_rgb(path); };
  const auto gray = [](const std::filesystem::path& path) { read_image_gray(path); };
  for (const char* content : {"", "no picture"}) {
    hold(content);
    refused(rgb);
    refused(stored_picture_size);
  }
  for (const char* suffix : {".png", ".jpg"}) {
    cv::Mat large;
    cv::resize(pattern(CV_8UC3), large, {110, 70});
    const std::string whole = encoded(suffix, large);
    for (const size_t size : {size_t{10}, whole.size() / 2, whole.size() - whole.size() / 10}) {
      hold(whole.substr(0, size));
      refused(rgb);
      refused(gray);
    }
  }
  // A picture of 60,000 x 60,000 pixels in sixty bytes.
  hold(encoded(".png", cv::Mat(1, 1, CV_8UC1)).replace(16, 8, std::string("\0\0\xea\x60\0\0\xea\x60", 8)));
  refused(rgb);
  std::string jpeg = encoded(".jpg", cv::Mat(8, 8, CV_8UC3, cv::Scalar(1, 2, 3)));
  const size_t size_at = jpeg.find("\xff\xc0") + 5;  // of the start of frame
  jpeg.replace(size_at, 4, "\xff\x00\xff\x00", 4);
  hold(jpeg);
  EXPECT_NE(refused(rgb).find("more than"), std::string::npos);
  std::filesystem::remove(path_);
  refused(gray);
  EXPECT_THROW(read_image_gray(scratch_.path()), IoError);
  EXPECT_THROW(write_png(ImageRgb{2, 2, {1, 2, 3}}, path_), LogicError);
  EXPECT_THROW(write_png(ImageRgb{1, 1, {1, 2, 3}}, ImageGray{1, 2, {1, 2}}, path_), LogicError);
  EXPECT_THROW(write_png(ImageRgb{2, 1, {1, 2, 3, 4, 5, 6}}, ImageGray{1, 2, {1, 2}}, path_), LogicError);
}

}  // namespace
}  // namespace livecap
