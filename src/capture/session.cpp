// run_capture: opens everything, warms up, runs the pipeline, closes the outputs.
#include <optional>

#include "base/trace.h"
#include "capture/capture_output.h"
#include "capture/engine.h"
#include "capture/fixed_lag.h"
#include "capture/frame_reader.h"
#include "capture/pipeline.h"
#include "image/image_io.h"
#include "livecap/capture.h"

namespace livecap {
namespace {

// Weight of either neighbour in the paper's filter of finished videos.
constexpr double kPaperShare = 0.15;

// The run itself. Its queues are closed when it returns.
CaptureReport capture(const CaptureOptions& options, const CaptureProgress& progress) {
  set_image_threads(1);
  const ocl::DevicePair devices = ocl::select_device_pair(options.cnn_device, options.solver_device);
  FrameReader reader(options);
  const CapturedActor who = load_captured_actor(options);
  BackgroundModel background;
  for (const ImageRgb& plate : reader.empty_plates()) background.train(plate);
  CaptureOutput output(options, who.actor, who.glb, reader.camera(), reader.info().fps);
  CaptureEngine engine(options, {options.model, options.detections, options.missed_detections, options.draw}, devices,
                       who.actor, reader.camera(), background);

  PipelineStages stages = engine.stages();
  stages.read = [&](WorkItem& item) {
    const TraceSpan span("read", "read", -1);
    return reader.read(item);
  };
  bool stopped_early = false;
  const auto publish = [&](WorkItem& item) {
    const TraceSpan span("output", "output", item.report.index);
    const FrameReport report = output.publish(item);
    stopped_early = progress && !progress(report, reader.n_frames());
    return !stopped_early;
  };
  FixedLag results(who.actor.skeleton, options.smooth ? kPaperShare : 0, 1);
  stages.publish = [&](WorkItem& item) {
    std::optional<WorkItem> ready = results.push(std::move(item));
    return !ready || publish(*ready);
  };
  if (options.sequential) {
    run_sequential(stages);
  } else {
    run_pipelined(stages, options.realtime, options.realtime ? engine.most_under_way() : 0);
  }
  while (std::optional<WorkItem> last = results.flush()) {
    if (!stopped_early) publish(*last);
  }
  return output.finish(devices, {stopped_early, reader.input_complete(), engine.buffers_made(), reader.warnings()});
}

}  // namespace

CaptureReport run_capture(const CaptureOptions& options, const CaptureProgress& progress) {
  options.validate();
  if (options.trace.empty()) return capture(options, progress);
  start_trace();
  try {
    const CaptureReport report = capture(options, progress);
    write_trace(options.trace);
    return report;
  } catch (...) {
    stop_trace();
    throw;
  }
}

}  // namespace livecap
