#include "level/level_export.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/floor_plane.h"
#include "base/log.h"
#include "base/part_file.h"
#include "base/require_apart.h"
#include "base/require_writable.h"
#include "base/text.h"
#include "eval/body_points.h"
#include "export/bvh.h"
#include "export/capture_glb.h"
#include "export/export_frame.h"
#include "export/frame_times.h"
#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

struct Stopped {};

// The rows asked for, in a level frame.
class LevelClip {
 public:
  LevelClip(const LevelExportOptions& options, const std::function<bool()>& go_on)
      : go_on_(go_on), capture_(open_capture(options.capture, options.actor, own_camera_file(options.capture), {})) {
    if (capture_.angles.empty())
      throw IoError((options.capture / "angles.csv").string() + ": is missing; `livecap capture` writes it");
    for (int64_t row = 0; row < static_cast<int64_t>(capture_.rows.size()); ++row) {
      const int64_t after = capture_.rows[row].index - options.first;
      if (after >= 0 && (options.frames < 0 || after < options.frames)) rows_.push_back(row);
    }
    const bool needs_vertices =
        std::ranges::any_of(options.out, [](const fs::path& out) { return out.extension() != ".bvh"; });
    if (capture_.vertices && needs_vertices)
      require_rows(capture_, rows_, "vertices.pc2", capture_.vertices->n_samples(), "samples");
    if (!options.floor.empty()) capture_.camera.floor = load_floor(options.floor);
    floor_ = options.level_camera ? floor_of_level_camera(capture_) : find_floor(capture_);
    for (int64_t row : rows_) {
      poses_.push_back({});
      if (!capture_.rows[row].tracked()) continue;
      const std::optional<Pose> pose = captured_pose(capture_, row, captured_joints(capture_, row));
      if (!pose)
        throw IoError((options.capture / "angles.csv").string() +
                      format(": frame %lld has no pose that fits the actor and joints.csv: they are of different runs, "
                             "or of an older version",
                             static_cast<long long>(capture_.rows[row].index)));
      poses_.back() = {true, *pose};
    }
    const auto first = std::find_if(poses_.begin(), poses_.end(), [](const CapturedFrame& f) { return f.tracked; });
    if (first == poses_.end())
      throw IoError((options.capture / "frames.csv").string() + ": nobody was tracked in the frames asked for");
    level_ = level_from_camera(floor_.floor, first->pose.root_translation_mm);
    for (CapturedFrame& frame : poses_) {
      if (!frame.tracked) continue;
      frame.pose.root_rotation = level_.linear() * frame.pose.root_rotation;
      frame.pose.root_translation_mm = level_ * frame.pose.root_translation_mm;
    }
  }

  // Asked once a frame. Throws Stopped.
  void require_going_on() const {
    if (go_on_ && !go_on_()) throw Stopped();
  }
  const CaptureFolder& capture() const { return capture_; }
  const CaptureFloor& floor() const { return floor_; }
  const Eigen::Isometry3d& level() const { return level_; }
  const std::vector<CapturedFrame>& poses() const { return poses_; }

  // Of the frames asked for; empty where they are evenly spaced.
  std::vector<double> uneven_times_s() const {
    std::vector<double> pts_ms;
    for (int64_t row : rows_) pts_ms.push_back(capture_.rows[row].pts_ms);
    return livecap::uneven_times_s(pts_ms, capture_.fps);
  }

  // [3*n] metres, glTF axes, of a tracked frame; NaN where the capture has none.
  void vertices(int frame, std::span<float> vertices_m) {
    require_going_on();
    std::vector<float> points = captured_vertices(capture_, rows_[frame]);
    points.resize(vertices_m.size(), std::numeric_limits<float>::quiet_NaN());
    for (size_t i = 0; i < points.size(); i += 3) {
      Eigen::Map<Eigen::Vector3f> point(&points[i]);
      point = (level_ * point.cast<double>()).cast<float>();
    }
    std::ranges::copy(gltf_from_camera(points), vertices_m.begin());
  }

 private:
  const std::function<bool()>& go_on_;
  CaptureFolder capture_;
  std::vector<int64_t> rows_;
  std::vector<CapturedFrame> poses_;  // of rows_
  CaptureFloor floor_;
  Eigen::Isometry3d level_;
};

// Of the files that know one rate only.
void warn_of_uneven(const LevelClip& clip, const std::vector<fs::path>& out) {
  std::string even;
  for (const fs::path& file : out) {
    if (file.extension() != ".glb") even += (even.empty() ? "" : " and ") + file.string();
  }
  if (!even.empty() && !clip.uneven_times_s().empty())
    log_warning(uneven_warning(clip.capture().path.string(), clip.capture().fps, "a .glb", even));
}

void write_glb(LevelClip& clip, const fs::path& path) {
  CaptureGlbOptions options;
  options.fps = clip.capture().fps;
  options.times_s = clip.uneven_times_s();
  options.camera = clip.capture().camera;
  options.frame_from_camera = clip.level();
  FrameVertices vertices;
  if (clip.capture().vertices) vertices = [&](int frame, std::span<float> out) { clip.vertices(frame, out); };
  write_capture_glb(path, clip.capture().actor, clip.poses(), vertices, options);
}

void write_motion(const LevelClip& clip, const fs::path& path, double unit_m) {
  BvhWriter bvh(path, clip.capture().actor, clip.capture().fps, unit_m);
  // At rest before anybody is tracked, as in a .pc2: standing, where a writer that knows no floor has the root at 0.
  const Eigen::Matrix3d camera_from_gltf = gltf_axes_from_camera().transpose();
  Pose rest = rest_pose(clip.capture().actor.skeleton);
  rest.root_translation_mm = camera_from_gltf * rest.root_translation_mm;
  rest.root_rotation = camera_from_gltf * rest.root_rotation;
  bool seen = false;
  for (const CapturedFrame& frame : clip.poses()) {
    clip.require_going_on();
    seen = seen || frame.tracked;
    if (frame.tracked)
      bvh.append(frame.pose);
    else if (seen)
      bvh.append_held();
    else
      bvh.append(rest);
  }
}

void write_points(LevelClip& clip, const fs::path& path) {
  if (!clip.capture().vertices)
    throw IoError((clip.capture().path / "vertices.pc2").string() + ": is missing; `livecap capture` writes it");
  const Actor& actor = clip.capture().actor;
  std::vector<float> held;  // the template at rest before anybody is tracked
  for (float value : actor.mesh.positions) held.push_back(static_cast<float>(kMetresPerMm * value));
  Pc2Writer pc2(path, actor.n_vertices());
  for (int frame = 0; frame < static_cast<int>(clip.poses().size()); ++frame) {
    if (clip.poses()[frame].tracked) clip.vertices(frame, held);
    pc2.append(held);
  }
}

}  // namespace

Eigen::Isometry3d level_from_camera(const Floor& floor, const Eigen::Vector3d& place_mm) {
  const Eigen::Quaterniond turn = upright_from_camera(floor.up);
  const Eigen::Vector3d origin = place_mm - floor.height_mm(place_mm) * floor.up;
  return Eigen::Isometry3d(turn) * Eigen::Translation3d(-origin);
}

LevelExportReport export_level(const LevelExportOptions& options, const std::function<bool()>& go_on) {
  for (const fs::path& out : options.out) {
    const fs::path kind = out.extension();
    if (kind != ".glb" && kind != ".bvh" && kind != ".pc2")
      throw ConfigError("--out " + out.string() + ": must end with .glb, .bvh or .pc2");
    if (kind != ".glb") require_no_pipe(out);  // their heads are written again when all frames are known
    require_writable(out);
  }
  std::vector<InputFile> inputs = capture_inputs("--capture", options.capture);
  inputs.push_back({"--actor", options.actor});
  inputs.push_back({"--floor", options.floor});
  require_apart(inputs, options.out);
  LevelClip clip(options, go_on);
  warn_of_uneven(clip, options.out);
  LevelExportReport report;
  try {
    for (const fs::path& out : options.out) {
      const fs::path kind = out.extension();
      PartFile part(out);
      if (kind == ".glb") write_glb(clip, part.path());
      if (kind == ".bvh") write_motion(clip, part.path(), options.bvh_unit_m);
      if (kind == ".pc2") write_points(clip, part.path());
      part.finish();
      ++report.files;
    }
  } catch (const Stopped&) {
  }

  const Floor& floor = clip.floor().floor;
  report.floor = clip.floor().source;
  report.tilt = tilt_above(plane_of(floor));
  report.camera_height_mm = floor.offset_mm;
  report.frames = static_cast<int64_t>(clip.poses().size());
  report.tracked = std::ranges::count_if(clip.poses(), [](const CapturedFrame& f) { return f.tracked; });
  return report;
}

}  // namespace livecap
