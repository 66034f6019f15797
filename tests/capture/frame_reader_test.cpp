#include "capture/frame_reader.h"

#include <gtest/gtest.h>

#include "base/scratch_folder.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "support/refusal.h"

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

}  // namespace
}  // namespace livecap
