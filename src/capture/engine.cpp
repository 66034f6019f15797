#include "capture/engine.h"

#include <algorithm>
#include <future>
#include <optional>
#include <string_view>
#include <thread>

#include "actor/keypoint_offsets.h"
#include "base/camera_tilt.h"
#include "base/floor_plane.h"
#include "base/log.h"
#include "base/text.h"
#include "base/trace.h"
#include "capture/components.h"
#include "capture/fixed_lag.h"
#include "capture/segmenter.h"
#include "capture/tracker.h"
#include "capture/warm_up.h"
#include "image/image_io.h"
#include "image/upright_edges.h"
#include "ocl/context.h"
#include "pose/floor.h"
#include "synth/named_actor.h"

namespace livecap {
namespace {

// Frames between the beginning of the network and the end of the solvers: one in the network, in either half of the
// segmentation, in the pose solver and in the surface solver, one handed over to each but the first, and those that
// wait for later poses.
constexpr int kLagFrames = 2;
constexpr int kStagesAtOnce = 5;
constexpr int kFramesUnderWay = 2 * kStagesAtOnce - 1 + kLagFrames;

bool is_on(const MethodOptions& options, std::string_view component) {
  return std::count(options.without.begin(), options.without.end(), component) == 0;
}

// Threads 5 and 6: both stages. Between them each pose waits for the next two, so that the surface is fitted to a
// steady one.
class Solver {
 public:
  // surface_device: the same, with a queue of its own.
  Solver(const MethodOptions& options, ocl::DeviceContext& device, ocl::DeviceContext& surface_device,
         const Actor& actor, const Camera& camera, const BackgroundModel& background)
      : camera_(camera),
        upright_due_(is_on(options, kUpright) && !camera.floor),
        tracker_(device, surface_device, actor, camera, tracker_options(options)),
        poses_(actor.skeleton, is_on(options, kFixedLag) ? kLagFrames : 0, steady_weights({})) {
    warm_up_tracker(tracker_, actor, camera);
    if (upright_due_ && background.trained()) look_for_upright(background.picture(), {});
  }

  std::optional<WorkItem> solve(WorkItem&& item) {
    if (item.report.status != TrackStatus::kDamaged) {
      const TraceSpan span("solve", "pose", item.report.index);
      if (upright_due_ && item.silhouette.area_px > 0) look_for_upright(item.image, item.mask);
      item.result = tracker_.solve_pose(input_of(item));
      item.report.status = item.result.status;
    }
    return poses_.push(std::move(item));
  }

  std::optional<WorkItem> flush() { return poses_.flush(); }

  void start_over() {
    while (flush()) {
    }
    tracker_.lose_person();
  }

  std::optional<FloorPlane> floor() const {
    const Floor* floor = tracker_.floor();
    if (!floor) return std::nullopt;
    const FloorPlane plane = plane_of(*floor);
    return fault_of(plane).empty() ? std::optional(plane) : std::nullopt;
  }

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
  // In the empty room, or else beside the first person in it.
  void look_for_upright(const ImageRgb& picture, const ImageGray& person) {
    upright_due_ = false;
    const std::optional<Upright> upright = upright_by_edges(picture, person, camera_);
    if (!upright) return log_debug("no upright edges tell which way is up");
    const CameraTilt tilt = tilt_above({{upright->up.x(), upright->up.y(), upright->up.z()}});
    log_debug(format("the camera looks down by %.1f deg, by %d upright edges", tilt.down_deg, upright->n_edges));
    tracker_.set_upright(*upright);
  }

  static TrackInput input_of(const WorkItem& item) {
    return {item.image,       item.detections,           item.silhouette, item.mask,
            item.frame.get(), item.report.pts_ms / 1000, item.nobody};
  }

  static TrackerOptions tracker_options(const MethodOptions& options) {
    TrackerOptions tracker;
    tracker.enable_surface = options.surface;
    tracker.surface.constant_rigidity = static_cast<float>(options.rigidity);
    for (const std::string& name : options.without) switch_off(name, tracker);
    return tracker;
  }

  Camera camera_;
  bool upright_due_;
  Tracker tracker_;
  FixedLag poses_;
};

}  // namespace

CapturedActor load_captured_actor(const MethodOptions& options) {
  CapturedActor who;
  who.glb = named_actor_glb(options.actor, options.height_mm);
  who.actor = load_actor_bytes(who.glb, options.actor, is_builtin_actor(options.actor) ? 0 : options.height_mm);
  use_mediapipe_anchors(who.actor);
  return who;
}

struct CaptureEngine::Parts {
  Parts(const ocl::DevicePair& devices, const Camera& given_camera)
      : camera(given_camera),
        one_gpu(devices.cnn.is_gpu && devices.cnn.device == devices.solver.device),
        solver_device(devices.solver, "solvers' device"),
        surface_device(solver_device, ocl::SharedMemory{}, "solvers' device, surface"),
        segmenter_device(solver_device, ocl::SharedMemory{}, "solvers' device, segmentation"),
        gate_device(solver_device, ocl::SharedMemory{}, "solvers' device, gate") {
    if (one_gpu) {
      cnn.emplace(solver_device, ocl::SharedMemory{}, "network's device");
    } else {
      cnn.emplace(devices.cnn, "network's device");
    }
  }

  void detect(WorkItem& item) {
    const TraceSpan span("network", "network", item.report.index);
    Timer timer;
    // On one GPU the picture goes there once, to where the segmentation and the solvers look at it.
    if (one_gpu && detection->shows(item.report.index)) {
      item.frame = segmenter->take_frame();
      item.frame->has_picture = true;
    }
    item.detections = detection->detect(item.image, camera, item.report.index, item.report.pts_ms / 1000,
                                        item.frame ? &item.frame->rgb : nullptr);
    item.report.score = item.detections.score;
    item.report.stage_ms[static_cast<int>(CaptureStage::kNetwork)] = timer.elapsed_ms();
  }

  Camera camera;
  // On one GPU all is in one context: a GPU that changes between contexts lets each wait for hundreds of microseconds.
  bool one_gpu;
  ocl::DeviceContext solver_device;
  ocl::DeviceContext surface_device;
  ocl::DeviceContext segmenter_device;  // outlives the solver, which holds frames of it
  ocl::DeviceContext gate_device;
  std::optional<ocl::DeviceContext> cnn;
  std::optional<DetectionSource> detection;
  std::optional<Solver> solver;
  std::optional<Segmenter> segmenter;
  int frames_waiting = 0;  // for later poses
  int64_t buffers_before = 0;
};

CaptureEngine::CaptureEngine(const MethodOptions& options, const DetectionOptions& detections,
                             const ocl::DevicePair& devices, const Actor& actor, const Camera& camera,
                             const BackgroundModel& background)
    : parts_(std::make_unique<Parts>(devices, camera)) {
  Parts& p = *parts_;
  // The network's kernels are compiled or loaded beside the solvers': each has its queue. Where the system allows no
  // further thread they come afterwards.
  std::future<void> network_ready = std::async(std::launch::async | std::launch::deferred, [&] {
    p.detection.emplace(detections, *p.cnn);
    p.detection->warm_up(camera);
  });
  p.solver.emplace(options, p.solver_device, p.surface_device, actor, camera, background);
  p.segmenter.emplace(p.segmenter_device, p.gate_device, background, camera, is_on(options, kMaskGating),
                      kFramesUnderWay);
  p.segmenter->warm_up();
  network_ready.get();
  p.frames_waiting = is_on(options, kFixedLag) ? kLagFrames : 0;
  p.buffers_before = ocl::BufferMemory::made;
}

CaptureEngine::~CaptureEngine() = default;

PipelineStages CaptureEngine::stages() {
  Parts& p = *parts_;
  const auto is_damaged = [](const WorkItem& item) { return item.report.status == TrackStatus::kDamaged; };
  PipelineStages stages;
  stages.detect = [&p, is_damaged](WorkItem& item) {
    if (!is_damaged(item)) p.detect(item);
  };
  stages.gate = [&p, is_damaged](WorkItem& item) {
    const TraceSpan span("gate", "gate", item.report.index);
    if (!is_damaged(item)) p.segmenter->find_gate(item);
  };
  stages.segment = [&p, is_damaged](WorkItem& item) {
    const TraceSpan span("segment", "segment", item.report.index);
    if (!is_damaged(item)) p.segmenter->segment(item);
  };
  stages.solve = [&p](WorkItem&& item) { return p.solver->solve(std::move(item)); };
  stages.flush = [&p] { return p.solver->flush(); };
  stages.surface = [&p](WorkItem& item) { p.solver->solve_surface(item); };
  return stages;
}

void CaptureEngine::start_over() {
  parts_->detection->start_over();
  parts_->segmenter->start_over();
  parts_->solver->start_over();
}

int CaptureEngine::most_under_way() const {
  const int at_work = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kStagesAtOnce);
  return parts_->frames_waiting + at_work + 1;
}

std::optional<FloorPlane> CaptureEngine::floor() const {
  return parts_->solver->floor();
}

int64_t CaptureEngine::buffers_made() const {
  return ocl::BufferMemory::made - parts_->buffers_before;
}

}  // namespace livecap
