// The shared library called from C gives what LiveCapture gives.
#include "c_api/embed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "capture/capture_run.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/live.h"
#include "nn/models.h"

namespace livecap {
namespace {

constexpr int kFrames = 8, kEmptyFrames = 2;

bool same_bytes(const void* a, const void* b, size_t bytes) {
  return a && b && std::memcmp(a, b, bytes) == 0;
}

// The same picture with blue first, a fourth byte a pixel, rows of some bytes more, and the lowest row first.
std::vector<uint8_t> bottom_up_bgra(const ImageRgb& image, int row_bytes) {
  std::vector<uint8_t> bytes(size_t(row_bytes) * image.height, 77);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const uint8_t* rgb = &image.pixels[3 * (size_t(y) * image.width + x)];
      std::reverse_copy(rgb, rgb + 3, &bytes[size_t(image.height - 1 - y) * row_bytes + 4 * x]);
    }
  }
  return bytes;
}

void expect_same(const embed_result& c, const LiveResult& cpp, const embed_run& run) {
  EXPECT_EQ(c.index, cpp.report.index);
  EXPECT_EQ(c.time_s, cpp.report.pts_ms / 1000);
  EXPECT_EQ(c.status, static_cast<int>(cpp.report.status));
  EXPECT_EQ(c.score, cpp.report.score);
  EXPECT_EQ(c.iou, cpp.report.iou);
  EXPECT_EQ(c.is_tracked, is_tracked(cpp.report.status));
  if (!is_tracked(cpp.report.status)) {
    EXPECT_TRUE(!c.bones && !c.angles_rad && !c.vertices_m);
    return;
  }
  EXPECT_TRUE(same_bytes(c.vertices_m, cpp.vertices_m.data(), 3 * sizeof(float) * run.n_vertices)) << c.index;
  EXPECT_TRUE(same_bytes(c.angles_rad, cpp.angles_rad.data(), sizeof(float) * run.n_angles)) << c.index;
  ASSERT_EQ(size_t(run.n_bones), cpp.bones.size());
  for (int b = 0; b < run.n_bones; ++b) {
    const LiveBonePose& bone = cpp.bones[b];
    EXPECT_TRUE(same_bytes(c.bones + 7 * b, bone.position_m.data(), 3 * sizeof(float))) << b;
    EXPECT_TRUE(same_bytes(c.bones + 7 * b + 3, bone.rotation.data(), 4 * sizeof(float))) << b;
  }
}

TEST(Embed, FromCTheSameResultsAsFromCpp) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  write_sequence(test::small_sequence(kFrames, kEmptyFrames), scratch / "sequence");
  const ImageRgb plate = read_image_rgb(scratch / "sequence/background.png");
  std::vector<Frame> frames;
  VideoReader reader(scratch / "sequence/video.mp4");
  for (Frame frame; reader.read(frame);) frames.push_back(frame);
  ASSERT_EQ(frames.size(), size_t(kFrames));

  LiveOptions options;
  options.camera = load_camera(scratch / "sequence/camera.json");
  options.background = {{.pixels = plate.pixels.data(), .width = plate.width, .height = plate.height}};
  options.actor = scratch / "sequence/actor.glb";
  options.model = model;
  options.cnn_device = options.solver_device = test::device_selectors().front();
  options.every_picture = true;
  std::vector<LiveResult> expected;
  {
    LiveCapture live(options, [&](const LiveResult& result) {
      expected.push_back(result);
      return true;
    });
    for (const Frame& frame : frames)
      ASSERT_TRUE(live.push({.pixels = frame.image.pixels.data(),
                             .width = plate.width,
                             .height = plate.height,
                             .time_s = frame.pts_ms / 1000}));
    live.close();
  }

  livecap_options c;
  livecap_options_init(&c);
  ASSERT_EQ(livecap_load_camera((scratch / "sequence/camera.json").c_str(), &c.camera), LIVECAP_OK);
  const livecap_picture background = {plate.pixels.data(), 0, 0, plate.width, plate.height, LIVECAP_RGB};
  c.background = &background;
  c.n_background = 1;
  c.actor = options.actor.c_str();
  c.model = options.model.c_str();
  c.cnn_device = options.cnn_device.c_str();
  c.solver_device = options.solver_device.c_str();
  c.every_picture = 1;
  const int row_bytes = 4 * plate.width + 12;
  std::vector<std::vector<uint8_t>> bytes;
  std::vector<livecap_picture> pictures;
  for (const Frame& frame : frames) {
    bytes.push_back(bottom_up_bgra(frame.image, row_bytes));
    pictures.push_back({&bytes.back()[size_t(plate.height - 1) * row_bytes], -row_bytes, frame.pts_ms / 1000,
                        plate.width, plate.height, LIVECAP_BGRA});
  }
  embed_run run;
  EXPECT_EQ(embed(&c, pictures.data(), kFrames, &run), LIVECAP_OK) << livecap_last_error();
  EXPECT_EQ(run.close_error, LIVECAP_OK);

  ASSERT_EQ(run.n_heard, kFrames);
  ASSERT_EQ(expected.size(), size_t(kFrames));
  int tracked = 0;
  for (int i = 0; i < kFrames; ++i) {
    expect_same(run.heard[i], expected[i], run);
    tracked += run.heard[i].is_tracked;
  }
  EXPECT_GE(tracked, kFrames - kEmptyFrames - 1);
  // What was polled is newer every time, down to the last.
  ASSERT_GE(run.n_polled, 1);
  for (int i = 0; i < run.n_polled; ++i) {
    expect_same(run.polled[i], expected[run.polled[i].index], run);
    if (i > 0) EXPECT_GT(run.polled[i].index, run.polled[i - 1].index);
  }
  EXPECT_EQ(run.polled[run.n_polled - 1].index, kFrames - 1);
  embed_free(&run);
}

}  // namespace
}  // namespace livecap
