#include "image/video.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "base/text.h"
#include "image/image_io.h"
#include "image/picture_converter.h"
#include "livecap/error.h"
#include "support/data_dir.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

class Video : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / format("livecap_video_test_%d_%s", static_cast<int>(::getpid()),
                                                 ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  // A smooth gradient with a square that moves and a brightness that tells the frame number.
  static ImageRgb picture(int width, int height, int frame) {
    ImageRgb image{width, height, std::vector<uint8_t>(size_t(3) * width * height)};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        uint8_t* p = &image.pixels[3 * (size_t(y) * width + x)];
        const bool square = std::abs(x - width / 4 - frame) < 8 && std::abs(y - height / 2) < 8;
        p[0] = square ? 220 : static_cast<uint8_t>(60 + 2 * frame);
        p[1] = static_cast<uint8_t>(60 + 100 * x / width);
        p[2] = square ? 30 : static_cast<uint8_t>(60 + 100 * y / height);
      }
    }
    return image;
  }

  std::string write_video(const std::string& name, int frames, int width = 96, int height = 64) {
    VideoWriter writer(path(name), width, height, 25);
    for (int i = 0; i < frames; ++i) writer.write(picture(width, height, i));
    writer.close();
    return path(name);
  }

  std::string write_bytes(const std::string& name, const std::string& bytes) {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  // The message of the IoError that opening `source` must throw.
  static std::string refusal(const std::string& source) {
    try {
      VideoReader reader(source);
    } catch (const Error& e) {
      return e.what();
    }
    ADD_FAILURE() << source << " was accepted";
    return {};
  }

  fs::path folder_;
};

double mean_difference(const ImageRgb& a, const ImageRgb& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(int(a.pixels[i]) - int(b.pixels[i]));
  return sum / static_cast<double>(a.pixels.size());
}

TEST_F(Video, WhatIsWrittenComesBackFrameByFrame) {
  VideoReader reader(write_video("a.mp4", 40));
  EXPECT_EQ(reader.info().width, 96);
  EXPECT_EQ(reader.info().height, 64);
  EXPECT_DOUBLE_EQ(reader.info().fps, 25);
  EXPECT_EQ(reader.info().frame_count_hint, 40);
  Frame frame;
  int n = 0;
  for (; reader.read(frame); ++n) {
    EXPECT_EQ(frame.index, n);
    EXPECT_NEAR(frame.pts_ms, 40.0 * n, test::kPtsMs);
    EXPECT_FALSE(frame.damaged);
    // Colours survive: a wrong matrix or range would be off by 5 to 20.
    EXPECT_LT(mean_difference(frame.image, picture(96, 64, n)), test::kVideoColour) << "frame " << n;
  }
  EXPECT_EQ(n, 40);
  EXPECT_FALSE(reader.truncated());
  EXPECT_EQ(reader.damaged_frames(), 0);
  EXPECT_FALSE(reader.read(frame));
}

TEST_F(Video, StartsWhereAsked) {
  VideoReader reader(write_video("ten.mp4", 10));
  reader.start_at(7);
  Frame frame;
  for (int i = 7; i < 10; ++i) {
    ASSERT_TRUE(reader.read(frame));
    EXPECT_EQ(frame.index, i);
  }
  EXPECT_FALSE(reader.read(frame));

  VideoReader whole(path("ten.mp4"));
  whole.start_at(0);
  ASSERT_TRUE(whole.read(frame));
  EXPECT_EQ(frame.index, 0);
}

TEST_F(Video, StartingAfterTheEndSaysHowLongItIs) {
  const std::string video = write_video("ten.mp4", 10);
  for (int first : {10, 100000}) {
    VideoReader reader(video);
    try {
      reader.start_at(first);
      FAIL() << first << " was accepted";
    } catch (const ConfigError& e) {
      EXPECT_NE(std::string(e.what()).find("--first " + std::to_string(first)), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("10 frames"), std::string::npos) << e.what();
    }
  }
}

TEST_F(Video, OddSizesGrowByOne) {
  VideoReader reader(write_video("odd.mp4", 3, 65, 63));
  EXPECT_EQ(reader.info().width, 66);
  EXPECT_EQ(reader.info().height, 64);
}

// What malloc returns is filled with it; 0: left as it is.
void fill_fresh_memory([[maybe_unused]] int byte) {
#ifdef __GLIBC__
  mallopt(M_PERTURB, byte);
#endif
}

TEST_F(Video, TheSamePicturesGiveTheSameBytes) {
  // Rows of 270 and 271 pixels end within a vector register: what lies behind the picture must not matter. The pictures
  // lie in larger blocks filled differently, so that reading past them shows; fresh memory is filled differently too,
  // for the libraries below.
  for (int width : {270, 271}) {
    std::vector<std::string> files;
    for (uint8_t filler : {0, 255, 97}) {
      const std::string name = format("repeat_%d_%d.mp4", width, filler);
      fill_fresh_memory(filler);
      VideoWriter writer(path(name), width, 64, 25);
      for (int i = 0; i < 25; ++i) {
        ImageRgb image = picture(width, 64, i);
        std::mt19937 noise(i);
        for (uint8_t& value : image.pixels) value = static_cast<uint8_t>(value + noise() % 16);
        const std::vector<uint8_t> pixels = image.pixels;
        image.pixels.assign(pixels.size() + 4096, filler);
        std::copy(pixels.begin(), pixels.end(), image.pixels.begin());
        image.pixels.resize(pixels.size());  // keeps the capacity and what is in it
        writer.write(image);
      }
      writer.close();
      files.push_back(read_file(path(name)));
    }
    fill_fresh_memory(0);
    EXPECT_TRUE(files[0] == files[1]) << width;
    EXPECT_TRUE(files[0] == files[2]) << width;
  }
}

TEST_F(Video, AnUnfinishedFileIsNotCalledComplete) {
  {
    VideoWriter writer(path("b.mp4"), 96, 64, 25);
    writer.write(picture(96, 64, 0));
    EXPECT_FALSE(fs::exists(path("b.mp4")));
  }
  EXPECT_FALSE(fs::exists(path("b.mp4")));
  write_video("b.mp4", 2);
  EXPECT_TRUE(fs::exists(path("b.mp4")));
  EXPECT_FALSE(fs::exists(path("b.mp4.part")));
}

TEST_F(Video, ALinkIsFollowedAndAPipeRefused) {
  fs::create_directories(path("below"));
  fs::create_symlink("below/real.mp4", path("link.mp4"));
  write_video("link.mp4", 2);
  EXPECT_TRUE(fs::is_symlink(path("link.mp4")));
  EXPECT_FALSE(fs::is_symlink(path("below/real.mp4")));
  EXPECT_TRUE(fs::exists(path("below/real.mp4")));
  ASSERT_EQ(::mkfifo(path("pipe.mp4").c_str(), 0600), 0);
  EXPECT_THROW(VideoWriter(path("pipe.mp4"), 96, 64, 25), IoError);
  EXPECT_TRUE(fs::is_fifo(path("pipe.mp4")));
}

TEST_F(Video, WriterRefusesBadArguments) {
  EXPECT_THROW(VideoWriter(path("c.mp4"), 0, 64, 25), ConfigError);
  EXPECT_THROW(VideoWriter(path("c.mp4"), 96, 64, 0), ConfigError);
  EXPECT_THROW(VideoWriter(path("no/such/folder/c.mp4"), 96, 64, 25), IoError);
  VideoWriter writer(path("c.mp4"), 96, 64, 25);
  EXPECT_THROW(writer.write(picture(64, 96, 0)), LogicError);
}

TEST_F(Video, BadFilesAreRefusedInOneLineThatNamesThem) {
  std::mt19937 random(3);
  std::string garbage(20000, 0);
  for (char& c : garbage) c = static_cast<char>(random());
  const std::string whole = read_file(write_video("whole.mp4", 10));
  std::string text;
  for (int i = 0; i < 500; ++i) text += "not a video\n";
  for (const std::string& source :
       {path("missing.mp4"), write_bytes("empty.mp4", ""), write_bytes("garbage.mp4", garbage),
        write_bytes("text.txt", text), write_bytes("head.mp4", whole.substr(0, 200))}) {
    const std::string message = refusal(source);
    EXPECT_NE(message.find(source), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_NE(refusal(path("missing.mp4")).find("no such file"), std::string::npos);
  EXPECT_NE(refusal(path("empty.mp4")).find("empty"), std::string::npos);
  fs::create_directory(path("folder"));
  EXPECT_NE(refusal(path("folder")).find("no .png"), std::string::npos);
  EXPECT_THROW(VideoReader(""), ConfigError);
  EXPECT_THROW(VideoReader("webcam:x"), ConfigError);
  // No camera has this number. The message tells it, whether or not libavdevice is installed.
  EXPECT_NE(refusal("webcam:987654").find("webcam:987654"), std::string::npos);
}

// What comes through a pipe is gone when it has been read.
TEST_F(Video, FilesAndFoldersCanBeReadAgain) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_FALSE(can_be_read_again(path("pipe")));
  EXPECT_FALSE(can_be_read_again("webcam:0"));
  EXPECT_FALSE(can_be_read_again(path("missing.mp4")));
  EXPECT_TRUE(can_be_read_again(write_bytes("video.mp4", "some")));
  fs::create_directory(path("pictures"));
  EXPECT_TRUE(can_be_read_again(path("pictures")));
}

TEST_F(Video, ATruncatedFileGivesItsReadableFramesAndSaysSo) {
  const std::string whole = read_file(write_video("t.mp4", 60));  // the index is at the front
  VideoReader reader(write_bytes("cut.mp4", whole.substr(0, whole.size() * 6 / 10)));
  Frame frame;
  int n = 0;
  while (reader.read(frame)) ++n;
  EXPECT_GT(n, 5);
  EXPECT_LT(n, 60);
  EXPECT_TRUE(reader.truncated());
}

TEST_F(Video, DamageNeverChangesTheNumberOfFrames) {
  const std::string whole = read_file(write_video("d.mp4", 60));
  int damaged_files = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    std::string bytes = whole;
    const size_t media = whole.find("mdat") + 4;
    // Random bytes or zeros over a twentieth of the pictures, sparing the first ones.
    const size_t length = (whole.size() - media) / 20;
    const size_t from = media + (whole.size() - media) / 4 + random() % ((whole.size() - media) / 2);
    for (size_t i = from; i < from + length; ++i) bytes[i] = seed % 2 ? 0 : static_cast<char>(random());
    VideoReader reader(write_bytes("broken.mp4", bytes));
    Frame frame;
    int n = 0;
    double last_pts = -1;
    for (; reader.read(frame); ++n) {
      EXPECT_EQ(frame.index, n);
      EXPECT_NEAR(frame.pts_ms, 40.0 * n, test::kPtsMs);
      EXPECT_GT(frame.pts_ms, last_pts);
      EXPECT_EQ(frame.image.pixels.size(), 3u * 96 * 64);
      last_pts = frame.pts_ms;
    }
    EXPECT_EQ(n, 60) << "seed " << seed;
    EXPECT_FALSE(reader.truncated());
    damaged_files += reader.damaged_frames() > 0;
  }
  EXPECT_GE(damaged_files, 10);
}

TEST_F(Video, FoldersAreReadInOrderAndBadPicturesAreDamagedFrames) {
  for (int i : {2, 0, 1, 3}) write_png(picture(20, 10, 10 * i), folder_ / format("%06d.png", i));
  write_bytes("000004.png", "broken");
  write_png(picture(21, 10, 0), folder_ / "000005.png");
  VideoReader reader(folder_.string());
  EXPECT_EQ(reader.info().frame_count_hint, 6);
  Frame frame;
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(reader.read(frame));
    EXPECT_EQ(frame.index, i);
    EXPECT_EQ(frame.damaged, i >= 4);
    EXPECT_EQ(frame.image.pixels, picture(20, 10, 10 * std::min(i, 3)).pixels);
  }
  EXPECT_FALSE(reader.read(frame));
  EXPECT_EQ(reader.damaged_frames(), 2);
}

TEST_F(Video, DisplayMatricesTurnPixels) {
  // FFmpeg's matrices (16.16 fixed point) for a quarter turn clockwise and for a mirrored picture.
  const int one = 1 << 16;
  const int32_t clockwise[9] = {0, one, 0, -one, 0, 0, 0, 0, 1 << 30};
  const int32_t mirrored[9] = {-one, 0, 0, 0, one, 0, 0, 0, 1 << 30};
  const int32_t slanted[9] = {46341, 46341, 0, -46341, 46341, 0, 0, 0, 1 << 30};
  EXPECT_EQ(pixel_turn(clockwise).m, (std::array<int, 4>{0, -1, 1, 0}));  // right becomes down, down becomes left
  EXPECT_EQ(pixel_turn(mirrored).m, (std::array<int, 4>{-1, 0, 0, 1}));
  EXPECT_TRUE(pixel_turn(slanted).is_identity());
  EXPECT_TRUE(pixel_turn(nullptr).is_identity());
}

TEST_F(Video, RecordedSequenceHasThePlatesColours) {
  LIVECAP_DATA_OR_SKIP(sequence, "skirt_dance");
  VideoReader reader((sequence / "video.mp4").string());
  EXPECT_EQ(reader.info().frame_count_hint, 160);
  const ImageRgb plate = read_image_rgb(sequence / "background.png");
  Frame frame;
  ASSERT_TRUE(reader.read(frame));
  double bias[3] = {};
  for (size_t i = 0; i < plate.pixels.size(); ++i) bias[i % 3] += int(frame.image.pixels[i]) - int(plate.pixels[i]);
  for (double sum : bias) EXPECT_LT(std::abs(sum / (double(plate.width) * plate.height)), test::kPlateBias);
  int n = 1;
  while (reader.read(frame)) ++n;
  EXPECT_EQ(n, 160);
}

}  // namespace
}  // namespace livecap
