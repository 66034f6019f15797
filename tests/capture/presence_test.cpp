// People come and go, videos break off, live input comes too fast: every input frame has its row and its status.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "capture/capture_run.h"
#include "image/image_io.h"
#include "image/video.h"
#include "nn/models.h"

namespace livecap {
namespace {

TEST(Presence, APersonComesAndLeaves) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  constexpr int kEmpty = 30, kPerson = 12, kAfter = 20;
  write_sequence(test::small_sequence(kEmpty + kPerson, kEmpty), scratch / "sequence");
  // The empty room once more at the end, as a folder of pictures.
  const auto pictures = scratch / "pictures";
  std::filesystem::create_directories(pictures);
  VideoReader reader((scratch / "sequence/video.mp4").string());
  std::vector<ImageRgb> empty;
  int n = 0;
  for (Frame frame; reader.read(frame); ++n) {
    if (n < kEmpty) empty.push_back(frame.image);
    write_png(frame.image, pictures / format("%06d.png", n));
  }
  ASSERT_EQ(n, kEmpty + kPerson);
  for (int i = 0; i < kAfter; ++i, ++n) write_png(empty[i], pictures / format("%06d.png", n));

  CaptureOptions options = test::capture_of(scratch / "sequence", scratch / "capture", model);
  options.video = pictures;
  const CaptureReport report = run_capture(options);
  const auto rows = test::frame_rows(scratch / "capture");
  test::expect_every_frame_once(rows, n);
  for (int i = 0; i < kEmpty; ++i) EXPECT_EQ(rows[i].status, "nobody") << i;
  EXPECT_EQ(rows[kEmpty].status, "initialized");
  for (int i = kEmpty + 1; i < kEmpty + kPerson; ++i) EXPECT_EQ(rows[i].status, "ok") << i;
  for (int i = kEmpty + kPerson; i < n; ++i) EXPECT_EQ(rows[i].status, "nobody") << i;
  EXPECT_EQ(report.tracked, kPerson);
  EXPECT_EQ(report.dropped, 0);
}

TEST(Presence, LiveInputThatComesTooFastIsDroppedAndMarked) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  SynthOptions synth = test::small_sequence(40, 0);
  synth.fps = 240;
  write_sequence(synth, scratch / "sequence");
  CaptureOptions options = test::capture_of(scratch / "sequence", scratch / "capture", model);
  options.realtime = true;
  // Some devices keep up with 240 frames a second; whoever takes the results here does not.
  const CaptureReport report = run_capture(options, [](const FrameReport&, int64_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return true;
  });
  const auto rows = test::frame_rows(scratch / "capture");
  test::expect_every_frame_once(rows, 40);
  const auto dropped = std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.status == "dropped"; });
  EXPECT_EQ(report.frames, 40);
  EXPECT_EQ(report.dropped, dropped);
  EXPECT_GT(dropped, 0);
  EXPECT_EQ(rows.back().status, "ok");  // the newest always wins
}

TEST(Presence, AnInputThatBreaksOffIsReported) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  write_sequence(test::small_sequence(12, 0), scratch / "sequence");
  const std::string whole = read_file(scratch / "sequence/video.mp4");
  write_file_atomically(scratch / "cut.mp4", whole.substr(0, whole.size() * 6 / 10));
  CaptureOptions options = test::capture_of(scratch / "sequence", scratch / "capture", model);
  options.video = scratch / "cut.mp4";
  const CaptureReport report = run_capture(options);
  EXPECT_GT(report.frames, 0);
  EXPECT_LT(report.frames, 12);
  EXPECT_TRUE(report.complete);
  EXPECT_FALSE(report.input_complete);
  const auto json = nlohmann::json::parse(read_file(report.report));
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["input_complete"], false);
  ASSERT_FALSE(json["warnings"].empty());
  EXPECT_NE(json["warnings"][0].get<std::string>().find("cut.mp4"), std::string::npos);

  // Stopped by the caller.
  options.video = scratch / "sequence/video.mp4";
  const CaptureReport stopped = run_capture(options, [](const FrameReport& frame, int64_t) { return frame.index < 3; });
  EXPECT_FALSE(stopped.complete);
  EXPECT_EQ(stopped.frames, 4);
  EXPECT_EQ(nlohmann::json::parse(read_file(stopped.report))["complete"], false);
}

}  // namespace
}  // namespace livecap
