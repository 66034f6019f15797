// The frames that are looked at before a capture: what is kept of them, and that nothing else is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/text.h"
#include "capture/capture_run.h"
#include "nn/models.h"

namespace livecap {
namespace {

constexpr int kFrames = 30, kEmpty = 4;

// The lines of the first tracked frame and of the one after it.
std::string first_tracked(const std::filesystem::path& csv) {
  const std::string text = read_file(csv);
  const size_t from = text.find(format("\n%d,", kEmpty)), to = text.find(format("\n%d,", kEmpty + 2));
  return text.substr(from, to - from);
}

TEST(LearnFirst, TheFloorIsKnownFromTheFirstFrameAndAllElseStartsOver) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  CaptureOptions options = test::capture_of_squat(scratch, kFrames, kEmpty, false, model);
  std::vector<int64_t> seen, expected(kFrames);
  for (int i = 0; i < kFrames; ++i) expected[i] = i + 1;
  const auto captured = [&](int learn_frames, const std::vector<std::string>& without) {
    options.learn_frames = learn_frames;
    options.without = without;
    options.out = scratch / format("%d%zu", learn_frames, without.size());
    seen.clear();
    const CaptureReport report = run_capture(options, {}, [&](int64_t n_seen, int64_t n_frames) {
      seen.push_back(n_seen);
      EXPECT_EQ(n_frames, kFrames);
      return true;
    });
    EXPECT_TRUE(report.complete);
    EXPECT_EQ(report.device_allocations, 0);
    test::expect_every_frame_once(test::frame_rows(options.out), kFrames);
    return std::filesystem::path(options.out);
  };
  const auto on_the_way = captured(0, {}), beforehand = captured(90, {});
  EXPECT_EQ(seen, expected);
  const auto floorless = captured(90, {"floor"});
  captured(0, {"floor"});
  EXPECT_TRUE(seen.empty());

  EXPECT_EQ(test::frame_rows(beforehand)[kEmpty].status, "initialized");
  EXPECT_EQ(read_file(beforehand / "detections.jsonl"), read_file(on_the_way / "detections.jsonl"));
  // No floor is known in the first frames yet, unless it was learned beforehand.
  EXPECT_EQ(first_tracked(on_the_way / "angles.csv"), first_tracked(scratch / "01" / "angles.csv"));
  EXPECT_NE(first_tracked(beforehand / "angles.csv"), first_tracked(floorless / "angles.csv"));
}

// Frames of which the first pass has seen some already are seen as if it had not been.
TEST(LearnFirst, DetectionsAreThoseOfACaptureThatHasNotLearned) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  CaptureOptions options = test::capture_of_squat(scratch, kFrames, kEmpty, false, model);
  options.first = kEmpty + 6;
  options.frames = 8;
  std::vector<std::string> detections;
  for (const int64_t learn_frames : {0, 5, 90}) {
    options.learn_frames = learn_frames;
    const CaptureReport report = run_capture(options);
    EXPECT_EQ(report.frames, 8);
    EXPECT_EQ(report.learned_frames, std::min<int64_t>(learn_frames, 8));
    detections.push_back(read_file(scratch / "capture/detections.jsonl"));
  }
  EXPECT_GT(detections[0].size(), 1000u);
  EXPECT_EQ(detections[0], detections[1]);
  EXPECT_EQ(detections[0], detections[2]);
}

TEST(LearnFirst, FramesWithNobodyTeachNothing) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  CaptureOptions options = test::capture_of_squat(scratch, kFrames, kEmpty, false, model);
  options.frames = 12;
  std::vector<std::string> joints;
  for (const int learn_frames : {0, kEmpty}) {
    options.learn_frames = learn_frames;
    run_capture(options);
    joints.push_back(read_file(scratch / "capture/joints.csv"));
  }
  EXPECT_GT(joints[0].size(), 1000u);
  EXPECT_EQ(joints[0], joints[1]);
}

// And where frames come at their own pace nothing is looked at beforehand.
TEST(LearnFirst, WhoeverHasSeenEnoughBeginsTheCapture) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  CaptureOptions options = test::capture_of_squat(scratch, kFrames, kEmpty, false, model);
  options.learn_frames = 90;
  for (const bool realtime : {false, true}) {
    options.realtime = realtime;
    int n_seen = 0;
    const CaptureReport report = run_capture(options, {}, [&](int64_t, int64_t) { return ++n_seen < 7; });
    EXPECT_EQ(n_seen, realtime ? 0 : 7);
    EXPECT_TRUE(report.complete);
    test::expect_every_frame_once(test::frame_rows(scratch / "capture"), kFrames);
  }
}

}  // namespace
}  // namespace livecap
