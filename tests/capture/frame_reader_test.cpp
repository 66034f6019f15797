#include "capture/frame_reader.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "base/scratch_folder.h"
#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "support/refusal.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(FrameReader, PicturesOfASizeThatNoCaptureTakesAreRefused) {
  for (const auto& [width, height, refused] :
       {std::tuple{640, 1, true}, {1, 640, true}, {16001, 10, true}, {2, 2, false}}) {
    const ScratchFolder scratch;
    write_png(ImageRgb{width, height, std::vector<uint8_t>(size_t(3) * width * height, 90)}, scratch / "0.png");
    CaptureOptions options;
    options.video = scratch.path();
    options.fov_deg = 60;
    if (refused) {
      test::expect_refused<ConfigError>(
          [&] { FrameReader reader(options); },
          {options.video, std::to_string(width) + "x" + std::to_string(height), "2 to 16000"});
    } else {
      EXPECT_EQ(FrameReader(options).camera().width, width);
    }
  }
}

// What is read of it is gone: its empty pictures come before the frames that are asked for.
TEST(FrameReader, EmptyPicturesOfAPipeAreItsFirstFrames) {
  const ScratchFolder scratch;
  const auto picture = [](int grey) { return ImageRgb{64, 48, std::vector<uint8_t>(3 * 64 * 48, uint8_t(grey))}; };
  VideoWriter video(scratch / "video.mp4", 64, 48, 25);
  for (int i = 0; i < 8; ++i) video.write(picture(20 + 20 * i));
  video.close();
  const std::string bytes = read_file(scratch / "video.mp4"), pipe = scratch / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const auto& [first, decoded, then] : {std::tuple{2, false, 3}, {2, true, 3}, {5, true, 5}, {5, false, 5}}) {
    std::jthread sender([&] { std::ofstream(pipe, std::ios::binary) << bytes; });
    CaptureOptions options;
    options.video = pipe;
    options.fov_deg = 60;
    options.background_frames = 3;
    options.first = first;
    options.decoded = decoded;
    FrameReader reader(options);
    std::vector<int> plates;
    reader.start([&](const ImageRgb& plate) { plates.push_back(plate.pixels[0]); });
    ASSERT_EQ(plates.size(), 3u);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(plates[i], 20 + 20 * i, test::kVideoColour);
    WorkItem item;
    int n = then;
    for (; reader.read(item); ++n) {
      EXPECT_EQ(item.report.index, n);
      EXPECT_NEAR(item.image.pixels[0], 20 + 20 * n, test::kVideoColour);
    }
    EXPECT_EQ(n, 8);
  }
}

}  // namespace
}  // namespace livecap
