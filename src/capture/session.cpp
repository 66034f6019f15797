// run_capture: opens everything, warms up, runs the pipeline, closes the outputs.
#include <algorithm>
#include <future>
#include <limits>
#include <memory>
#include <optional>

#include "actor/keypoint_offsets.h"
#include "base/log.h"
#include "base/text.h"
#include "base/trace.h"
#include "capture/capture_output.h"
#include "capture/components.h"
#include "capture/fixed_lag.h"
#include "capture/frame_reader.h"
#include "capture/pipeline.h"
#include "capture/tracker.h"
#include "capture/warm_up.h"
#include "detect/detections_io.h"
#include "detect/pose_detector.h"
#include "image/device_distance.h"
#include "image/foreground.h"
#include "image/frame_pool.h"
#include "image/image_io.h"
#include "livecap/capture.h"
#include "livecap/error.h"
#include "ocl/context.h"
#include "synth/synth.h"

namespace livecap {
namespace {

constexpr std::string_view kBuiltin = "builtin:";
// Frames between the beginning of the network and the end of the solvers: one in the network, in either half of the
// segmentation, in the pose solver and in the surface solver, one handed over to each but the first, and those that
// wait for later poses, as many as there are passes.
constexpr int kLagPasses = 2;
constexpr int kFramesUnderWay = 9 + kLagPasses;
// Weight of either neighbour in a pose that the surface is fitted to, and in the paper's filter of finished videos. Of
// noise that differs from frame to frame two passes with 0.3 leave hardly more acceleration than with any other share.
constexpr double kLagShare = 0.3;
constexpr double kPaperShare = 0.15;

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
  DetectionSource(const CaptureOptions& options, ocl::DeviceContext& device)
      : missed_share_(options.missed_detections) {
    if (!options.detections.empty()) {
      recorded_ = detect::load_detections(options.detections);
      return;
    }
    detect::PoseDetectorOptions detector;
    detector.model = options.model;
    detector.lay_mask = false;
    network_.emplace(device, detector);
  }

  void warm_up(const Camera& camera) {
    if (network_) warm_up_detector(*network_, camera);
  }

  // Whether a network is shown the frame.
  bool shows(int64_t frame_index) const { return network_ && !is_missed(frame_index); }

  // on_device: see BlazePose::set_picture; of frames that are shown only.
  Detections detect(const ImageRgb& image, const Camera& camera, int64_t frame_index, double time_s,
                    ocl::Buffer<uint8_t>* on_device) {
    const bool missed = is_missed(frame_index);
    if (network_ && missed) return network_->detect(black_picture(camera), camera, frame_index, time_s);
    if (network_) return network_->detect(image, camera, frame_index, time_s, on_device);
    for (; next_ < recorded_.size() && recorded_[next_].frame_index <= frame_index; ++next_) {
      if (recorded_[next_].frame_index == frame_index && !missed) return recorded_[next_];
    }
    Detections nobody;
    nobody.frame_index = frame_index;
    return nobody;
  }

 private:
  // One in 1 / share of the frames, the same in every run: the hash of SplitMix64 (Steele et al. 2014).
  bool is_missed(int64_t frame_index) const {
    uint64_t x = (static_cast<uint64_t>(frame_index) + 1) * 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53 < missed_share_;
  }
  static ImageRgb black_picture(const Camera& camera) {
    return {camera.width, camera.height, std::vector<uint8_t>(size_t(3) * camera.width * camera.height, 0)};
  }

  double missed_share_;
  std::optional<detect::PoseDetector> network_;
  std::vector<Detections> recorded_;
  size_t next_ = 0;
};

// Threads 3 and 4: which pixels are the person. In the first frames without one, in case that the network has just
// missed the person: which are not the background. gated: the network's mask takes part; without an empty plate it
// always does.
class Segmenter {
 public:
  // device, gate_device: the solver's, each with a queue of its own.
  Segmenter(ocl::DeviceContext& device, ocl::DeviceContext& gate_device, const BackgroundModel& background,
            const Camera& camera, bool gated)
      : device_(device),
        foreground_(device, gate_device, background, camera.width, camera.height),
        distance_(device, camera.width, camera.height),
        frames_(device, gate_device, camera.width, camera.height, kFramesUnderWay),
        gated_(gated || !background.trained()) {
    foreground_.prepare_crop_masks(detect::BlazePose::kCropSize);
  }

  // For the picture, before the frame is segmented. May be called by another thread.
  std::shared_ptr<DeviceFrame> take_frame() { return frames_.take(); }

  // In the order of frames: it counts those without anybody.
  void find_gate(WorkItem& item) {
    Timer timer;
    const bool person = item.detections.person;
    missed_frames_ = person ? 0 : missed_frames_ + 1;
    if (person || (foreground_.has_background() && missed_frames_ <= kMaxMissedFrames)) {
      if (!item.frame) item.frame = frames_.take();
      item.gate = foreground_.find_gate(item.image, network_mask(item), crop_mask(item), *item.frame);
    } else {
      item.frame.reset();
    }
    item.report.stage_ms[static_cast<int>(CaptureStage::kSegment)] = timer.elapsed_ms();
  }

  // May run beside find_gate() of later frames.
  void segment(WorkItem& item) {
    Timer timer;
    if (item.frame) {
      const ForegroundResult found =
          foreground_.segment(item.gate, network_mask(item), crop_mask(item) != nullptr, *item.frame, item.mask);
      item.silhouette.width = item.mask.width;
      item.silhouette.height = item.mask.height;
      item.silhouette.area_px = found.area_px;
      item.silhouette.box = found.box;
      if (found.area_px > 0) distance_.compute(item.frame->mask, found.box, found.area_px, item.frame->signed_distance);
      device_.finish();
    }
    item.report.stage_ms[static_cast<int>(CaptureStage::kSegment)] += timer.elapsed_ms();
  }

 private:
  // The network's, where it takes part: of the picture, or of the crop.
  const PersonMask& network_mask(const WorkItem& item) const { return gated_ ? item.detections.mask : no_mask_; }
  const CropMask* crop_mask(const WorkItem& item) const {
    return gated_ && item.detections.crop_mask ? &*item.detections.crop_mask : nullptr;
  }

  ocl::DeviceContext& device_;
  ForegroundSegmenter foreground_;
  DeviceDistanceField distance_;
  FramePool frames_;
  const PersonMask no_mask_;
  bool gated_;
  int64_t missed_frames_ = std::numeric_limits<int32_t>::max();  // nobody yet
};

// Threads 5 and 6: both stages. Between them each pose waits for the next two, so that the surface is fitted to a
// steady one.
class Solver {
 public:
  // surface_device: the same, with a queue of its own.
  Solver(const CaptureOptions& options, ocl::DeviceContext& device, ocl::DeviceContext& surface_device,
         const Actor& actor, const Camera& camera, double lag_share)
      : tracker_(device, surface_device, actor, camera, tracker_options(options)),
        poses_(actor.skeleton, lag_share, kLagPasses) {
    warm_up_tracker(tracker_, actor, camera);
  }

  std::optional<WorkItem> solve(WorkItem&& item) {
    if (item.report.status != TrackStatus::kDamaged) {
      const TraceSpan span("solve", "pose", item.report.index);
      item.result = tracker_.solve_pose(input_of(item));
      item.report.status = item.result.status;
    }
    return poses_.push(std::move(item));
  }

  std::optional<WorkItem> flush() { return poses_.flush(); }

  // May run beside solve() of later frames.
  void solve_surface(WorkItem& item) {
    if (item.report.status == TrackStatus::kDamaged) return;
    const TraceSpan span("surface", "surface", item.report.index);
    const TrackResult& result = item.result;
    tracker_.solve_surface(input_of(item), item.result);
    item.frame.reset();
    item.report.stage_ms[static_cast<int>(CaptureStage::kPose)] = result.pose_ms;
    item.report.stage_ms[static_cast<int>(CaptureStage::kSurface)] = result.surface_ms;
    item.report.iou = result.iou;
    item.report.pose_energy = result.pose_energy;
    item.report.surface_energy = result.surface_energy;
    item.report.keypoint_error_px = result.keypoint_error_px;
  }

 private:
  static TrackInput input_of(const WorkItem& item) {
    return {item.image, item.detections, item.silhouette, item.mask, item.frame.get(), item.report.pts_ms / 1000};
  }

  static TrackerOptions tracker_options(const CaptureOptions& options) {
    TrackerOptions tracker;
    tracker.enable_surface = options.surface;
    tracker.surface.constant_rigidity = static_cast<float>(options.rigidity);
    for (const std::string& name : options.without) switch_off(name, tracker);
    return tracker;
  }

  Tracker tracker_;
  FixedLag poses_;
};

// The run itself. Its queues are closed when it returns.
CaptureReport capture(const CaptureOptions& options, const CaptureProgress& progress) {
  set_image_threads(1);
  const ocl::DevicePair devices = ocl::select_device_pair(options.cnn_device, options.solver_device);
  FrameReader reader(options);
  const std::string glb = actor_bytes(options);
  const bool builtin = options.actor.rfind(kBuiltin, 0) == 0;
  Actor actor = load_actor_bytes(glb, options.actor, builtin ? 0 : options.height_mm);
  use_mediapipe_anchors(actor);
  BackgroundModel background;
  for (const ImageRgb& plate : reader.empty_plates()) background.train(plate);
  CaptureOutput output(options, actor, glb, reader.camera(), reader.info().fps);

  const auto with = [&](std::string_view component) {
    return std::count(options.without.begin(), options.without.end(), component) == 0;
  };

  ocl::DeviceContext solver_device(devices.solver, "solvers' device");
  ocl::DeviceContext surface_device(solver_device, ocl::SharedMemory{}, "solvers' device, surface");
  ocl::DeviceContext segmenter_device(
      solver_device, ocl::SharedMemory{},
      "solvers' device, segmentation");  // outlives the solver, which holds frames of it
  ocl::DeviceContext gate_device(solver_device, ocl::SharedMemory{}, "solvers' device, gate");
  // On one GPU in one context: a GPU that changes between contexts lets each wait for hundreds of microseconds.
  const bool one_gpu = devices.cnn.is_gpu && devices.cnn.device == devices.solver.device;
  std::optional<ocl::DeviceContext> cnn;
  if (one_gpu) {
    cnn.emplace(solver_device, ocl::SharedMemory{}, "network's device");
  } else {
    cnn.emplace(devices.cnn, "network's device");
  }
  // The network's kernels are compiled or loaded beside the solvers': each has its queue.
  std::optional<DetectionSource> detection;
  std::future<void> network_ready = std::async(std::launch::async, [&] {
    detection.emplace(options, *cnn);
    detection->warm_up(reader.camera());
  });
  Solver solver(options, solver_device, surface_device, actor, reader.camera(), with(kFixedLag) ? kLagShare : 0);
  Segmenter segmenter(segmenter_device, gate_device, background, reader.camera(), with(kMaskGating));
  network_ready.get();

  PipelineStages stages;
  stages.read = [&](WorkItem& item) {
    const TraceSpan span("read", "read", -1);
    return reader.read(item);
  };
  stages.detect = [&](WorkItem& item) {
    if (item.report.status == TrackStatus::kDamaged) return;
    const TraceSpan span("network", "network", item.report.index);
    Timer timer;
    // On one GPU the picture goes there once, to where the segmentation and the solvers look at it.
    if (one_gpu && detection->shows(item.report.index)) {
      item.frame = segmenter.take_frame();
      item.frame->has_picture = true;
    }
    item.detections = detection->detect(item.image, reader.camera(), item.report.index, item.report.pts_ms / 1000,
                                        item.frame ? &item.frame->rgb : nullptr);
    item.report.score = item.detections.score;
    item.report.stage_ms[static_cast<int>(CaptureStage::kNetwork)] = timer.elapsed_ms();
  };
  stages.gate = [&](WorkItem& item) {
    const TraceSpan span("gate", "gate", item.report.index);
    if (item.report.status != TrackStatus::kDamaged) segmenter.find_gate(item);
  };
  stages.segment = [&](WorkItem& item) {
    const TraceSpan span("segment", "segment", item.report.index);
    if (item.report.status != TrackStatus::kDamaged) segmenter.segment(item);
  };
  stages.solve = [&](WorkItem&& item) { return solver.solve(std::move(item)); };
  stages.flush = [&] { return solver.flush(); };
  stages.surface = [&](WorkItem& item) { solver.solve_surface(item); };
  const int64_t buffers_before = ocl::BufferMemory::made;
  bool stopped_early = false;
  const auto publish = [&](WorkItem& item) {
    const TraceSpan span("output", "output", item.report.index);
    const FrameReport report = output.publish(item);
    stopped_early = progress && !progress(report, reader.n_frames());
    return !stopped_early;
  };
  FixedLag results(actor.skeleton, options.smooth ? kPaperShare : 0, 1);
  stages.publish = [&](WorkItem& item) {
    std::optional<WorkItem> ready = results.push(std::move(item));
    return !ready || publish(*ready);
  };
  if (options.sequential) {
    run_sequential(stages);
  } else {
    run_pipelined(stages, options.realtime);
  }
  while (std::optional<WorkItem> last = results.flush()) {
    if (!stopped_early) publish(*last);
  }
  return output.finish(
      devices, {stopped_early, reader.input_complete(), ocl::BufferMemory::made - buffers_before, reader.warnings()});
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
