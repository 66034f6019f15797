#include "render/backdrop.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap::render {
namespace {

const ImageRgb kVideo = {4, 2, std::vector<uint8_t>(24, 77)};

Backdrop backdrop(const std::string& background, bool about_person = false) {
  RenderOptions options;
  options.background = background;
  options.orbit = about_person;
  return {options, 40, 40};
}

std::vector<int> at(const ImageRgb& image, int x, int y) {
  const uint8_t* pixel = &image.pixels[3 * (size_t(y) * image.width + x)];
  return {pixel[0], pixel[1], pixel[2]};
}

TEST(Backdrop, AColourIsThat) {
  const ImageRgb picture = backdrop("#1a00FF").picture(kVideo);
  ASSERT_EQ(picture.pixels.size(), 3u * 40 * 40);
  EXPECT_EQ(at(picture, 39, 39), (std::vector<int>{26, 0, 255}));
  for (const char* wrong : {"#12345g", "#1234567", "sky", "# 12345"})
    EXPECT_THROW(backdrop(wrong), ConfigError) << wrong;
}

TEST(Backdrop, TheVideoIsAsLargeAsThereIsRoomForBetweenBars) {
  for (const char* background : {"", "video"}) {
    const ImageRgb picture = backdrop(background).picture(kVideo);  // 40x20 in the middle
    EXPECT_EQ(at(picture, 0, 9), (std::vector<int>{0, 0, 0}));
    EXPECT_EQ(at(picture, 0, 10), (std::vector<int>{77, 77, 77}));
    EXPECT_EQ(at(picture, 39, 29), (std::vector<int>{77, 77, 77}));
    EXPECT_EQ(at(picture, 39, 30), (std::vector<int>{0, 0, 0}));
  }
  EXPECT_NE(at(backdrop("", true).picture(kVideo), 20, 20), (std::vector<int>{77, 77, 77}));  // plain about the person
  EXPECT_TRUE(backdrop("none").is_transparent());
  EXPECT_FALSE(backdrop("").is_transparent());
}

TEST(Backdrop, AFileIsFittedLikewise) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / format("livecap_backdrop_%d.png", static_cast<int>(::getpid()));
  write_png(ImageRgb{2, 4, std::vector<uint8_t>(24, 99)}, file);
  const ImageRgb picture = backdrop(file.string()).picture(kVideo);  // 20x40 in the middle
  std::filesystem::remove(file);
  EXPECT_EQ(at(picture, 9, 20), (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(at(picture, 10, 20), (std::vector<int>{99, 99, 99}));
}

}  // namespace
}  // namespace livecap::render
