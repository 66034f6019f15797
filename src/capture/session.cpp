// run_capture: opens everything, warms up, learns of the first frames, runs the pipeline, closes the outputs.
#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include "base/trace.h"
#include "capture/capture_output.h"
#include "capture/engine.h"
#include "capture/file_sha256.h"
#include "capture/fixed_lag.h"
#include "capture/frame_reader.h"
#include "capture/pipeline.h"
#include "detect/find_model.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/capture.h"

namespace livecap {
namespace {

// Weight of either neighbour in the paper's filter of finished videos.
constexpr double kPaperShare = 0.15;

std::function<bool(WorkItem&)> reads(FrameReader& reader) {
  return [&reader](WorkItem& item) {
    const TraceSpan span("read", "read", -1);
    return reader.read(item);
  };
}

void run(const CaptureOptions& options, const CaptureEngine& engine, const PipelineStages& stages) {
  if (options.sequential) {
    run_sequential(stages);
  } else {
    run_pipelined(stages, options.realtime, options.realtime ? engine.most_under_way() : 0);
  }
}

// The poses of the first frames, of which the engine keeps what it learned of the room and the person. How many.
int64_t learn_first(const CaptureOptions& options, CaptureEngine& engine, const LearnProgress& learning) {
  if (options.learn_frames == 0 || options.realtime || !can_be_read_again(options.video)) return 0;
  const TraceSpan span("capture", "learn", -1);
  CaptureOptions first = options;
  first.background.clear();
  first.background_frames = 0;
  first.frames = options.frames < 0 ? options.learn_frames : std::min(options.learn_frames, options.frames);
  first.decoded = false;
  FrameReader reader(first);
  reader.start([](const ImageRgb&) {});
  PipelineStages stages = engine.stages();
  stages.read = reads(reader);
  stages.surface = [](WorkItem& item) { item.frame.reset(); };
  int64_t n_seen = 0;
  stages.publish = [&](WorkItem&) {
    ++n_seen;
    return !learning || learning(n_seen, reader.n_frames());
  };
  run(options, engine, stages);
  engine.start_over();
  return n_seen;
}

// The run itself. Its queues are closed when it returns.
CaptureReport capture(const CaptureOptions& options, const CaptureProgress& progress, const LearnProgress& learning) {
  const ImageThreads one_thread(1);
  CaptureOutput::make_folder(options);
  const ocl::DevicePair devices = ocl::select_device_pair(options.cnn_device, options.solver_device);
  const std::string model_sha256 =
      options.detections.empty() ? file_sha256(detect::find_model(options.model)) : std::string();
  FrameReader reader(options);
  const CapturedActor who = load_captured_actor(options);
  BackgroundModel background;
  reader.start([&](const ImageRgb& plate) { background.train(plate); });
  CaptureEngine engine(options, {options.model, options.detections, options.missed_detections, options.draw}, devices,
                       who.actor, reader.camera(), background);
  const int64_t learned_frames = learn_first(options, engine, learning);
  CaptureOutput output(options, who.actor, who.glb, reader.camera(), reader.info().fps);

  PipelineStages stages = engine.stages();
  stages.read = reads(reader);
  bool stopped_early = false;
  const auto publish = [&](WorkItem& item) {
    const TraceSpan span("output", "output", item.report.index);
    const FrameReport report = output.publish(item);
    stopped_early = progress && !progress(report, reader.n_frames());
    return !stopped_early;
  };
  FixedLag results(who.actor.skeleton, options.smooth ? 1 : 0, neighbor_weights(kPaperShare));
  stages.publish = [&](WorkItem& item) {
    std::optional<WorkItem> ready = results.push(std::move(item));
    return !ready || publish(*ready);
  };
  run(options, engine, stages);
  // A camera has no other end.
  const auto broken_off = [&] { return stopped_early && !is_webcam(options.video); };
  while (std::optional<WorkItem> last = results.flush()) {
    if (!broken_off()) publish(*last);
  }
  return output.finish(devices, model_sha256,
                       {broken_off(), reader.input_complete(), learned_frames, engine.buffers_made(), reader.warnings(),
                        engine.floor()});
}

}  // namespace

CaptureReport run_capture(const CaptureOptions& options, const CaptureProgress& progress,
                          const LearnProgress& learning) {
  options.validate();
  if (options.trace.empty()) return capture(options, progress, learning);
  start_trace();
  try {
    const CaptureReport report = capture(options, progress, learning);
    write_trace(options.trace);
    return report;
  } catch (...) {
    stop_trace();
    throw;
  }
}

}  // namespace livecap
