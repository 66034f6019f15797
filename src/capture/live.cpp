// LiveCapture: the pipeline of a video, fed by the caller and read by a callback.
#include "livecap/live.h"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <thread>
#include <utility>

#include "base/log.h"
#include "base/start_thread.h"
#include "base/text.h"
#include "base/trace.h"
#include "capture/channel.h"
#include "capture/engine.h"
#include "export/export_frame.h"
#include "image/picture_size.h"
#include "image/undistort.h"
#include "livecap/error.h"

namespace livecap {
namespace {

struct Layout {
  int bytes;
  int red, blue;  // where in a pixel
};

// Throws ConfigError.
Layout layout_of(PixelFormat pixels) {
  switch (pixels) {
    case PixelFormat::kRgb:
      return {3, 0, 2};
    case PixelFormat::kBgr:
      return {3, 2, 0};
    case PixelFormat::kRgba:
      return {4, 0, 2};
    case PixelFormat::kBgra:
      return {4, 2, 0};
  }
  throw ConfigError(format("PixelFormat %d: there is no such format", static_cast<int>(pixels)));
}

// Throws ConfigError.
ImageRgb copy_of(const Picture& picture, const Camera& camera, const char* what) {
  if (picture.width != camera.width || picture.height != camera.height)
    throw ConfigError(format("%s: it is %dx%d but the camera is %dx%d", what, picture.width, picture.height,
                             camera.width, camera.height));
  if (!picture.pixels) throw ConfigError(format("%s: it has no pixels", what));
  const Layout layout = layout_of(picture.format);
  const std::ptrdiff_t packed = std::ptrdiff_t(layout.bytes) * picture.width;
  const std::ptrdiff_t row_bytes = picture.row_bytes == 0 ? packed : picture.row_bytes;
  if (std::abs(row_bytes) < packed)
    throw ConfigError(format("%s: row_bytes is %td but a row has %td", what, row_bytes, packed));
  ImageRgb image{picture.width, picture.height, std::vector<uint8_t>(size_t(3) * picture.width * picture.height)};
  uint8_t* out = image.pixels.data();
  for (int y = 0; y < picture.height; ++y) {
    const uint8_t* in = picture.pixels + y * row_bytes;
    if (picture.format == PixelFormat::kRgb) {
      std::memcpy(out, in, packed);
      out += packed;
      continue;
    }
    for (int x = 0; x < picture.width; ++x, in += layout.bytes, out += 3) {
      out[0] = in[layout.red];
      out[1] = in[1];
      out[2] = in[layout.blue];
    }
  }
  return image;
}

std::array<float, 3> array_of(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

LiveActor live_actor(const CapturedActor& who) {
  LiveActor live;
  for (const Bone& bone : who.actor.skeleton.bones)
    live.bones.push_back({bone.name, bone.parent, array_of(kMetresPerMm * bone.offset_mm)});
  for (const Dof& dof : who.actor.skeleton.dofs) live.angles.push_back(dof.name);
  live.n_vertices = who.actor.n_vertices();
  live.triangles = who.actor.mesh.triangles;
  live.drawn_vertex = who.actor.render.template_vertex;
  live.drawn_uv = who.actor.render.uvs;
  live.drawn_triangles = who.actor.render.triangles;
  live.glb = who.glb;
  return live;
}

std::vector<LiveBonePose> bone_poses(const Skeleton& skeleton, const Pose& pose) {
  const PosedSkeleton posed = forward_kinematics(skeleton, pose);
  std::vector<LiveBonePose> bones(skeleton.n_bones());
  for (int b = 0; b < skeleton.n_bones(); ++b) {
    const int parent = skeleton.bones[b].parent;
    const Eigen::Matrix3d axes =
        parent < 0 ? gltf_axes_from_camera() : Eigen::Matrix3d(posed.camera_from_bone[parent].linear().transpose());
    const Eigen::Quaternionf rotation =
        Eigen::Quaterniond(Eigen::Matrix3d(axes * posed.camera_from_bone[b].linear())).normalized().cast<float>();
    bones[b].position_m = array_of(gltf_from_camera(Eigen::Vector3d(posed.camera_from_bone[b].translation())));
    bones[b].rotation = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
  }
  return bones;
}

}  // namespace

void LiveOptions::validate() const {
  MethodOptions::validate();
  camera.validate();
  require_picture_size("camera", camera.width, camera.height);
}

struct LiveCapture::State {
  State(const LiveOptions& given, LiveCallback callback)
      : on_result(std::move(callback)),
        camera(given.camera),
        every_picture(given.every_picture),
        undistorter(given.camera),
        who(load_captured_actor(given)),
        actor(live_actor(who)) {
    const ocl::DevicePair devices = ocl::select_device_pair(given.cnn_device, given.solver_device);
    BackgroundModel background;
    for (const Picture& plate : given.background)
      background.train(undistorter.undistort(copy_of(plate, camera, "background picture")));
    engine.emplace(given, DetectionOptions{given.model, {}, 0}, devices, who.actor, undistorter.undistorted_camera(),
                   background);
  }

  bool read(WorkItem& item) {
    std::optional<WorkItem> next = pictures.pop();
    if (!next) return false;
    const TraceSpan span("read", "read", next->report.index);
    Timer timer;
    item = std::move(*next);
    item.image = undistorter.undistort(std::move(item.image));
    item.report.stage_ms[static_cast<int>(CaptureStage::kRead)] = timer.elapsed_ms();
    return true;
  }

  bool publish(WorkItem& item) {
    if (abandoned) return false;
    for (const FrameReport& dropped : item.dropped_before) {
      if (!on_result({dropped, {}, {}, {}})) return false;
    }
    Timer timer;
    LiveResult result;
    if (is_tracked(item.report.status)) {
      const Pose& pose = item.result.pose;
      result.bones = bone_poses(who.actor.skeleton, pose);
      result.angles_rad.assign(pose.angles_rad.begin(), pose.angles_rad.end());
      result.vertices_m = gltf_from_camera(item.result.vertices_mm);
    }
    item.report.stage_ms[static_cast<int>(CaptureStage::kOutput)] = timer.elapsed_ms();
    item.report.latency_ms = item.since_read.elapsed_ms();
    result.report = item.report;
    return on_result(result);
  }

  void run() {
    try {
      PipelineStages stages = engine->stages();
      stages.read = [this](WorkItem& item) { return read(item); };
      stages.stop_reading = [this] { pictures.abort(); };
      stages.publish = [this](WorkItem& item) { return publish(item); };
      run_pipelined(stages, !every_picture, every_picture ? 0 : engine->most_under_way());
    } catch (...) {
      error = std::current_exception();
    }
    pictures.abort();
  }

  // Throws LogicError on the thread that calls on_result, which would wait for itself.
  void require_outside(const char* function) const {
    if (std::this_thread::get_id() == thread.get_id())
      throw LogicError(std::string("LiveCapture::") + function + " was called from on_result; return false to end");
  }

  LiveCallback on_result;
  Camera camera;
  bool every_picture;
  Undistorter undistorter;
  CapturedActor who;
  LiveActor actor;
  std::optional<CaptureEngine> engine;
  Channel<WorkItem> pictures;
  std::atomic<bool> abandoned = false;
  std::exception_ptr error;
  int64_t n_pushed = 0;
  double last_time_s = -std::numeric_limits<double>::infinity();
  std::thread thread;
};

LiveCapture::LiveCapture(const LiveOptions& options, LiveCallback on_result) {
  options.validate();
  if (!on_result) throw ConfigError("LiveCapture: on_result is empty, so that nobody would hear of the results");
  state_ = std::make_unique<State>(options, std::move(on_result));
  state_->thread = start_thread([state = state_.get()] { state->run(); });
}

LiveCapture::~LiveCapture() {
  state_->abandoned = true;
  state_->pictures.abort();
  if (state_->thread.joinable()) state_->thread.join();
  if (!state_->error) return;
  try {
    std::rethrow_exception(state_->error);
  } catch (const std::exception& error) {
    log_error(std::string("a live capture that nobody closed ended by an error: ") + error.what());
  } catch (...) {
    log_error("a live capture that nobody closed ended by an error");
  }
}

const LiveActor& LiveCapture::actor() const {
  return state_->actor;
}

bool LiveCapture::push(const Picture& picture) {
  State& s = *state_;
  s.require_outside("push()");
  if (s.pictures.aborted()) return false;  // whatever the picture is
  if (!(picture.time_s > s.last_time_s) || !std::isfinite(picture.time_s))
    throw ConfigError(
        format("picture %lld: its time is %g s, it must be finite and later than that of the one before%s",
               static_cast<long long>(s.n_pushed), picture.time_s,
               s.n_pushed == 0 ? "" : format(" (%g s)", s.last_time_s).c_str()));
  WorkItem item;
  item.image = copy_of(picture, s.camera, format("picture %lld", static_cast<long long>(s.n_pushed)).c_str());
  item.report.index = s.n_pushed;
  item.report.pts_ms = 1000 * picture.time_s;
  const bool taken =
      s.every_picture ? s.pictures.push(std::move(item)) : s.pictures.push_newest(std::move(item), inherit_dropped);
  if (!taken) return false;
  ++s.n_pushed;
  s.last_time_s = picture.time_s;
  return true;
}

void LiveCapture::close() {
  State& s = *state_;
  s.require_outside("close()");
  s.pictures.close();
  if (s.thread.joinable()) s.thread.join();
  if (s.error) std::rethrow_exception(std::exchange(s.error, nullptr));
}

}  // namespace livecap
