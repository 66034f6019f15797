#include "bench_capture.h"

#include <algorithm>

#include "base/text.h"
#include "base/timer.h"
#include "command.h"
#include "livecap/error.h"
#include "progress.h"

namespace livecap::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

}  // namespace

void make_bench_sequence(const SynthOptions& synth, const fs::path& folder) {
  Progress progress("synth");
  write_sequence(synth, folder, [&](int frame, int n_frames) {
    progress.update(frame, n_frames);
    return !interrupted();
  });
  progress.finish();
  if (interrupted()) throw Error("interrupted");
}

CaptureOptions bench_capture_options(const BenchOptions& options, const fs::path& sequence, const fs::path& out) {
  CaptureOptions capture;
  capture.video = (sequence / "video.mp4").string();
  capture.camera = (sequence / "camera.json").string();
  capture.background = (sequence / "background.png").string();
  capture.actor = (sequence / "actor.glb").string();
  capture.model = options.model;
  capture.cnn_device = options.cnn_device;
  capture.solver_device = options.solver_device;
  capture.frames = options.frames;
  capture.decoded = options.decoded;
  capture.learn_frames = 0;
  capture.out = out.string();
  return capture;
}

BenchRun bench_capture(const CaptureOptions& capture, const std::string& name) {
  BenchRun run;
  Progress progress(name);
  int64_t done = 0;
  bool after_tracked = false;
  Timer since_last;
  run.report = run_capture(capture, [&](const FrameReport& frame, int64_t n_frames) {
    const bool tracked = is_tracked(frame.status);
    if (tracked && after_tracked) run.intervals_ms.push_back(since_last.elapsed_ms());
    since_last.restart();
    after_tracked = tracked;
    progress.update(++done, n_frames);
    return !interrupted();
  });
  progress.finish();
  if (interrupted()) throw Error("interrupted");
  if (run.intervals_ms.empty()) throw Error(capture.video + ": nobody was tracked, there is nothing to measure");
  run.file = Json::parse(read_file(fs::path(capture.out) / "report.json"));
  return run;
}

Json stages_json(const CaptureReport& report) {
  Json json;
  for (int i = 0; i < kStageCount; ++i) json[stage_name(static_cast<CaptureStage>(i))] = report.stage_median_ms[i];
  return json;
}

Json run_json(const BenchRun& run) {
  Json json;
  json["frames"] = run.report.frames;
  json["tracked"] = run.report.tracked;
  json["frame_median_ms"] = median(run.intervals_ms);
  json["frame_p95_ms"] = percentile(run.intervals_ms, 0.95);
  json["fps"] = 1000 / median(run.intervals_ms);
  json["latency_median_ms"] = run.report.latency_ms;
  json["stage_median_ms"] = stages_json(run.report);
  return json;
}

}  // namespace livecap::tools
