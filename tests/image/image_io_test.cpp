#include "image/image_io.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

TEST(ImageIo, PngKeepsEveryByte) {
  const auto path =
      std::filesystem::temp_directory_path() / format("livecap_image_io_%d.png", static_cast<int>(::getpid()));
  ImageRgb rgb{5, 3, {}};
  ImageGray gray{5, 3, {}};
  for (int i = 0; i < 45; ++i) rgb.pixels.push_back(static_cast<uint8_t>(i * 37));
  for (int i = 0; i < 15; ++i) gray.pixels.push_back(static_cast<uint8_t>(i * 17));
  write_png(rgb, path);
  EXPECT_EQ(read_image_rgb(path).pixels, rgb.pixels);
  EXPECT_EQ(read_image_rgb(path).width, 5);
  write_png(gray, path);
  EXPECT_EQ(read_image_gray(path).pixels, gray.pixels);
  const ImageRgb as_rgb = read_image_rgb(path);
  for (int i = 0; i < 45; ++i) EXPECT_EQ(as_rgb.pixels[i], gray.pixels[i / 3]);
  std::filesystem::remove(path);
}

TEST(ImageIo, BadFilesAreNamed) {
  const auto path =
      std::filesystem::temp_directory_path() / format("livecap_image_io_bad_%d.png", static_cast<int>(::getpid()));
  for (const char* content : {"", "no picture"}) {
    std::ofstream(path) << content;
    try {
      read_image_rgb(path);
      ADD_FAILURE();
    } catch (const IoError& e) {
      EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
    }
  }
  std::filesystem::remove(path);
  EXPECT_THROW(read_image_gray(path), IoError);
  EXPECT_THROW(read_image_gray(std::filesystem::temp_directory_path()), IoError);
  EXPECT_THROW(write_png(ImageRgb{2, 2, {1, 2, 3}}, path), LogicError);
}

}  // namespace
}  // namespace livecap
