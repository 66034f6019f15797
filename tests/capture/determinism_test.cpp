// The same video gives the same bytes, whatever the threads do (docs/architecture.md, "Determinism").
#include <gtest/gtest.h>

#include "actor/actor.h"
#include "capture/capture_run.h"
#include "livecap/error.h"
#include "nn/models.h"

namespace livecap {
namespace {

TEST(Determinism, PipelinedAndSequentialRunsGiveTheSameBytes) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  constexpr int kFrames = 24;
  write_sequence(test::small_sequence(kFrames, 2), scratch / "sequence");

  const std::vector<std::pair<std::string, bool>> runs = {{"first", false}, {"one_thread", true}, {"again", false}};
  for (const auto& [name, sequential] : runs) {
    CaptureOptions options = test::capture_of(scratch / "sequence", scratch / name, model);
    options.sequential = sequential;
    options.learn_frames = 10;
    const CaptureReport report = run_capture(options);
    EXPECT_EQ(report.frames, kFrames);
    EXPECT_GE(report.tracked, kFrames - 4) << name;
    EXPECT_TRUE(report.complete);
    EXPECT_TRUE(report.input_complete);
    EXPECT_EQ(report.device_allocations, 0) << name;
    test::expect_every_frame_once(test::frame_rows(scratch / name), kFrames);

    const Actor captured = load_actor_bytes(read_file(report.glb), "capture.glb", 0);
    EXPECT_EQ(captured.n_vertices(), load_actor(scratch / "sequence/actor.glb").n_vertices());
  }
  // Everything without a clock in it.
  for (const char* file :
       {"vertices.pc2", "motion.bvh", "joints.csv", "angles.csv", "detections.jsonl", "capture.glb"}) {
    const std::string first = read_file(scratch / "first" / file);
    EXPECT_GT(first.size(), 1000u) << file;
    EXPECT_TRUE(first == read_file(scratch / "one_thread" / file)) << file << " differs in one thread";
    EXPECT_TRUE(first == read_file(scratch / "again" / file)) << file << " differs when repeated";
  }
}

// Whenever the frames are decoded. A webcam's cannot be beforehand.
TEST(Determinism, FramesDecodedBeforehandGiveTheSameBytes) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ScratchFolder scratch;
  write_sequence(test::small_sequence(14, 2), scratch / "sequence");
  std::vector<std::string> vertices;
  for (const bool decoded : {false, true}) {
    CaptureOptions options = test::capture_of(scratch / "sequence", scratch / "capture", model);
    options.decoded = decoded;
    options.first = 3;
    options.frames = 8;
    const CaptureReport report = run_capture(options);
    EXPECT_EQ(report.frames, 8);
    EXPECT_TRUE(report.input_complete);
    EXPECT_EQ(test::frame_rows(scratch / "capture").front().index, 3);
    EXPECT_NE(read_file(report.report).find(decoded ? "\"decoded\": true" : "\"decoded\": false"), std::string::npos);
    vertices.push_back(read_file(report.pc2));
    options.video = "webcam:0";
    if (decoded) {
      EXPECT_THROW(options.validate(), ConfigError);
    }
  }
  EXPECT_GT(vertices[0].size(), 1000u);
  EXPECT_TRUE(vertices[0] == vertices[1]);
}

}  // namespace
}  // namespace livecap
