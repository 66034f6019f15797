#include "image/empty_picture.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

ImageRgb plain(int width, int height, uint8_t value) {
  return {width, height, std::vector<uint8_t>(size_t(3) * width * height, value)};
}

// A folder of three pictures, of which the second may be damaged.
class EmptyPicture : public ::testing::Test {
 protected:
  std::string video(bool damaged) const {
    const fs::path folder = folder_ / (damaged ? "damaged" : "whole");
    fs::create_directories(folder);
    for (int i = 0; i < 3; ++i) {
      const fs::path file = folder / format("%d.png", i);
      if (damaged && i == 1)
        write_file_atomically(file, "no picture");
      else
        write_png(plain(8, 6, static_cast<uint8_t>(10 * i)), file);
    }
    return folder.string();
  }
  std::vector<ImageRgb> read(const std::string& background, int n_frames, const std::string& video) const {
    VideoReader reader(video);
    std::vector<ImageRgb> pictures;
    read_empty_pictures(background, n_frames, video, reader,
                        [&](ImageRgb&& picture) { pictures.push_back(std::move(picture)); });
    return pictures;
  }
  template <typename Error>
  std::string refusal(const std::string& background, int n_frames, const std::string& video) const {
    try {
      read(background, n_frames, video);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
  void TearDown() override { fs::remove_all(folder_); }

  const fs::path folder_ = fs::path(testing::TempDir()) / "empty_picture";
};

TEST_F(EmptyPicture, IsAFileOrTheFirstFrames) {
  const std::string whole = video(false);
  EXPECT_TRUE(read("", 0, whole).empty());
  const std::vector<ImageRgb> frames = read("", 2, whole);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].pixels, plain(8, 6, 10).pixels);
  EXPECT_EQ(read(whole + "/2.png", 0, whole).at(0).pixels, plain(8, 6, 20).pixels);
}

TEST_F(EmptyPicture, IsNotTheWholeVideo) {
  const std::string whole = video(false);
  for (int n : {3, 100})
    EXPECT_EQ(refusal<ConfigError>("", n, whole),
              format("--background-frames %d: %s has 3 frames, and some must show the person", n, whole.c_str()));
}

TEST_F(EmptyPicture, MustBeReadable) {
  const std::string damaged = video(true);
  EXPECT_EQ(read("", 2, damaged).size(), 1u);
  const std::string small = (folder_ / "small.png").string();
  write_png(plain(4, 4, 0), small);
  EXPECT_EQ(refusal<IoError>(small, 0, damaged), small + ": the picture is 4x4 but the video is 8x6");
}

}  // namespace
}  // namespace livecap
