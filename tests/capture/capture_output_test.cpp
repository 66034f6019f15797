#include "capture/capture_output.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "base/text.h"
#include "export/motion_fixture.h"
#include "image/video.h"
#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

constexpr int kSize = 64;
constexpr double kFps = 25;

CaptureOptions options_into(const char* name) {
  CaptureOptions options;
  options.video = "none.mp4";
  options.out = (fs::path(testing::TempDir()) / name).string();
  fs::remove_all(options.out);
  return options;
}

WorkItem item_of(int64_t index) {
  WorkItem item;
  item.image = {kSize, kSize, std::vector<uint8_t>(size_t{3} * kSize * kSize, 128)};
  item.report.index = index;
  item.report.pts_ms = 1000 * static_cast<double>(index) / kFps;
  return item;
}

std::vector<double> times_in(const fs::path& film) {
  VideoReader reader(film.string());
  std::vector<double> times;
  for (Frame frame; reader.read(frame);) times.push_back(frame.pts_ms);
  return times;
}

// The name of a folder need not be UTF-8, which JSON has to be.
TEST(CaptureOutput, TheReportIsWrittenWhateverTheFolderIsCalled) {
  CaptureOptions options = options_into("capture_output_caf\xe9");
  options.background = options.out + "/background.png";
  const Actor actor = test::small_actor();
  CaptureOutput::make_folder(options);
  CaptureOutput output(options, actor, "glb", camera_from_fov(kSize, kSize, 60), kFps);
  WorkItem item = item_of(0);
  output.publish(item);
  const std::string report = read_file(output.finish({}, "", {}).report);
  EXPECT_NE(report.find("capture_output_caf\xef\xbf\xbd/background.png"), std::string::npos) << report;
}

// Pictures that live pacing drops have rows; the film shows the next one when it was taken.
TEST(CaptureOutput, DroppedPicturesDoNotSpeedUpTheFilm) {
  CaptureOptions options = options_into("capture_output_dropped");
  options.overlay = true;
  const Actor actor = test::small_actor();
  CaptureOutput::make_folder(options);
  CaptureOutput output(options, actor, "glb", camera_from_fov(kSize, kSize, 60), kFps);
  WorkItem first = item_of(0), later = item_of(3);
  for (int64_t dropped : {1, 2}) {
    later.dropped_before.push_back(item_of(dropped).report);
    later.dropped_before.back().status = TrackStatus::kDropped;
  }
  output.publish(first);
  output.publish(later);
  const CaptureReport report = output.finish({}, "", {});
  EXPECT_EQ(report.frames, 4);
  EXPECT_EQ(report.dropped, 2);
  const std::vector<double> times = times_in(report.overlay);
  ASSERT_EQ(times.size(), 2u);
  EXPECT_NEAR(times[1], 3 * 1000 / kFps, 1);
}

TEST(CaptureOutput, SaysThatFramesDoNotComeEvenly) {
  for (const bool uneven : {false, true}) {
    const CaptureOptions options = options_into("capture_output_uneven");
    const Actor actor = test::small_actor();
    CaptureOutput::make_folder(options);
    CaptureOutput output(options, actor, "glb", camera_from_fov(kSize, kSize, 60), kFps);
    for (int64_t index = 0; index < 4; ++index) {
      WorkItem item = item_of(index);
      if (uneven && index > 1) item.report.pts_ms += 100;
      output.publish(item);
    }
    const CaptureReport report = output.finish({}, "", {});
    const bool said = std::any_of(report.warnings.begin(), report.warnings.end(), [](const std::string& warning) {
      return warning.find("do not come evenly") != std::string::npos;
    });
    EXPECT_EQ(said, uneven);
  }
}

// Nothing of an earlier run is lost by one that cannot begin.
TEST(CaptureOutput, MakesItsFolderAndTouchesNothing) {
  CaptureOptions options = options_into("capture_output_folder");
  CaptureOutput::make_folder(options);
  const fs::path folder = options.out;
  for (const char* name : {"report.json", "detections.jsonl", "camera.json"}) std::ofstream(folder / name) << "kept";
  CaptureOutput::make_folder(options);
  options.detections = (folder / "detections.jsonl").string();
  EXPECT_THROW(CaptureOutput::make_folder(options), ConfigError);
  for (const char* name : {"report.json", "detections.jsonl", "camera.json"})
    EXPECT_EQ(read_file(folder / name), "kept") << name;
  options.detections.clear();
  options.out = (folder / "report.json").string();
  EXPECT_THROW(CaptureOutput::make_folder(options), IoError);
}

}  // namespace
}  // namespace livecap
