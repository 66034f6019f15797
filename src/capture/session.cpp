// run_capture: opens everything, warms up, runs the pipeline, closes the outputs.
#include <algorithm>
#include <memory>
#include <optional>

#include "actor/keypoint_offsets.h"
#include "base/log.h"
#include "base/text.h"
#include "capture/capture_output.h"
#include "capture/components.h"
#include "capture/frame_reader.h"
#include "capture/pipeline.h"
#include "capture/tracker.h"
#include "capture/warm_up.h"
#include "detect/detections_io.h"
#include "detect/pose_detector.h"
#include "image/foreground.h"
#include "image/image_io.h"
#include "livecap/capture.h"
#include "livecap/error.h"
#include "ocl/context.h"
#include "synth/synth.h"

namespace livecap {
namespace {

constexpr std::string_view kBuiltin = "builtin:";

// The actor's GLB as bytes: a file, or one of the built-in figures.
std::string actor_bytes(const CaptureOptions& options) {
  if (options.actor.rfind(kBuiltin, 0) == 0)
    return make_builtin_actor_glb(options.actor.substr(kBuiltin.size()),
                                  options.height_mm > 0 ? options.height_mm : kBuiltinHeightMm);
  return read_file(options.actor);
}

// Thread 2: the network, or detections from a file.
class DetectionSource {
 public:
  DetectionSource(const CaptureOptions& options, ocl::DeviceContext& device, double fps) {
    if (!options.detections.empty()) {
      recorded_ = detect::load_detections(options.detections);
      return;
    }
    detect::PoseDetectorOptions detector;
    detector.model = options.model;
    detector.frame_rate_hz = fps > 0 ? fps : 30;
    network_.emplace(device, detector);
  }

  void warm_up(const Camera& camera) {
    if (network_) warm_up_detector(*network_, camera);
  }

  Detections detect(const ImageRgb& image, const Camera& camera, int64_t frame_index) {
    if (network_) return network_->detect(image, camera, frame_index);
    for (; next_ < recorded_.size() && recorded_[next_].frame_index <= frame_index; ++next_) {
      if (recorded_[next_].frame_index == frame_index) return recorded_[next_];
    }
    Detections nobody;
    nobody.frame_index = frame_index;
    return nobody;
  }

 private:
  std::optional<detect::PoseDetector> network_;
  std::vector<Detections> recorded_;
  size_t next_ = 0;
};

// Thread 3: which pixels are the person. gated: the network's mask takes part; without an empty plate it always does.
void segment(const ForegroundModel& foreground, bool gated, WorkItem& item) {
  Timer timer;
  if (item.detections.person) {
    item.mask =
        foreground.segment(item.image, gated || !foreground.has_background() ? item.detections.mask : PersonMask());
    item.silhouette = make_silhouette(item.mask);
  }
  item.report.stage_ms[static_cast<int>(CaptureStage::kSegment)] = timer.elapsed_ms();
}

// Thread 4: both stages.
class Solver {
 public:
  Solver(const CaptureOptions& options, ocl::DeviceContext& device, const Actor& actor, const Camera& camera)
      : tracker_(device, actor, camera, tracker_options(options)) {
    warm_up_tracker(tracker_, actor, camera);
  }

  void solve(WorkItem& item) {
    item.result = tracker_.track({item.image, item.detections, item.silhouette, item.mask});
    auto& stage_ms = item.report.stage_ms;
    stage_ms[static_cast<int>(CaptureStage::kPose)] = item.result.pose_ms;
    stage_ms[static_cast<int>(CaptureStage::kSurface)] = item.result.surface_ms;
    item.report.status = item.result.status;
    item.report.iou = item.result.iou;
    item.report.pose_energy = item.result.pose_energy;
    item.report.surface_energy = item.result.surface_energy;
    item.report.keypoint_error_px = item.result.keypoint_error_px;
  }

 private:
  static TrackerOptions tracker_options(const CaptureOptions& options) {
    TrackerOptions tracker;
    tracker.enable_surface = options.surface;
    tracker.surface.constant_rigidity = static_cast<float>(options.rigidity);
    for (const std::string& name : options.without) switch_off(name, tracker);
    return tracker;
  }

  Tracker tracker_;
};

}  // namespace

CaptureReport run_capture(const CaptureOptions& options, const CaptureProgress& progress) {
  options.validate();
  set_image_threads(1);
  FrameReader reader(options);
  const std::string glb = actor_bytes(options);
  const bool builtin = options.actor.rfind(kBuiltin, 0) == 0;
  Actor actor = load_actor_bytes(glb, options.actor, builtin ? 0 : options.height_mm);
  use_mediapipe_anchors(actor);
  ForegroundModel foreground;
  for (const ImageRgb& plate : reader.empty_plates()) foreground.train(plate);
  CaptureOutput output(options, actor, glb, reader.camera(), reader.info().fps);

  const ocl::DevicePair devices = ocl::select_device_pair(options.cnn_device, options.solver_device);
  ocl::DeviceContext cnn(devices.cnn);
  ocl::DeviceContext solver_device(devices.solver);
  DetectionSource detection(options, cnn, reader.info().fps);
  detection.warm_up(reader.camera());
  Solver solver(options, solver_device, actor, reader.camera());

  const bool gated = std::count(options.without.begin(), options.without.end(), kMaskGating) == 0;
  PipelineStages stages;
  stages.read = [&](WorkItem& item) { return reader.read(item); };
  stages.detect = [&](WorkItem& item) {
    if (item.report.status == TrackStatus::kDamaged) return;
    Timer timer;
    item.detections = detection.detect(item.image, reader.camera(), item.report.index);
    item.report.score = item.detections.score;
    item.report.stage_ms[static_cast<int>(CaptureStage::kNetwork)] = timer.elapsed_ms();
  };
  stages.segment = [&](WorkItem& item) {
    if (item.report.status != TrackStatus::kDamaged) segment(foreground, gated, item);
  };
  stages.solve = [&](WorkItem& item) {
    if (item.report.status != TrackStatus::kDamaged) solver.solve(item);
  };
  bool stopped_early = false;
  stages.publish = [&](WorkItem& item) {
    const FrameReport report = output.publish(item);
    stopped_early = progress && !progress(report, reader.n_frames());
    return !stopped_early;
  };
  if (options.sequential) {
    run_sequential(stages);
  } else {
    run_pipelined(stages, options.realtime);
  }
  return output.finish(devices, {stopped_early, reader.input_complete(), reader.warnings()});
}

}  // namespace livecap
