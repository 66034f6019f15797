#include "views/companion_files.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/scratch_folder.h"
#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Of 3 x 2 pixels, or 3 x 3; the first one is set.
ImageGray dot(int width, int height, int at = 0) {
  ImageGray image{width, height, std::vector<uint8_t>(size_t(width) * height, 0)};
  image.pixels[at] = 255;
  return image;
}

// The bright pixel of the upright file of `picture`.
int dot_of(CompanionFiles& files, const StoredPicture& picture) {
  const auto file = files.of(picture.name);
  const ImageGray image = files.upright(read_image_gray(file), file, picture);
  return static_cast<int>(std::find(image.pixels.begin(), image.pixels.end(), 255) - image.pixels.begin());
}

// What was turned by 180 degrees, and square pictures, are as those of this folder whose size tells.
TEST(CompanionFiles, FilesThatCouldBeEitherAreAsTheOthersOfTheirFolder) {
  const ScratchFolder folder;
  const std::vector<StoredPicture> pictures = {
      {"quarter.jpg", 3, 2, 1}, {"half.jpg", 3, 2, 2}, {"square.jpg", 3, 3, 3}, {"plain.jpg", 3, 2, 0}};
  write_png(dot(3, 2), folder / "half.png");
  write_png(dot(3, 3), folder / "square.png");
  write_png(dot(3, 2), folder / "plain.png");
  const auto dots = [&](int n_unclear) {
    CompanionFiles files(folder.path(), pictures);
    std::vector<int> found;
    for (const StoredPicture& picture : pictures)
      if (!files.of(picture.name).empty()) found.push_back(dot_of(files, picture));
    EXPECT_EQ(files.n_unclear(), n_unclear);
    return found;
  };
  EXPECT_EQ(dots(2), (std::vector<int>{0, 0, 0})) << "nothing tells";
  write_png(dot(3, 2), folder / "quarter.png");  // as stored: the first pixel goes to the upper right of 2 x 3
  EXPECT_EQ(dots(0), (std::vector<int>{1, 5, 6, 0}));
  write_png(dot(2, 3, 4), folder / "quarter.png");  // upright
  EXPECT_EQ(dots(0), (std::vector<int>{4, 0, 0, 0}));
  write_png(dot(3, 3), folder / "half.png");
  try {
    dots(0);
    ADD_FAILURE() << "another size";
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(), (folder / "half.png").string() + ": 3 x 3, its picture is 3 x 2");
  }
}

}  // namespace
}  // namespace livecap
