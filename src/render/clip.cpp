#include "render/clip.h"

#include <algorithm>
#include <limits>

#include "base/median.h"
#include "base/text.h"
#include "eval/body_points.h"
#include "livecap/error.h"

namespace livecap::render {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

std::vector<int64_t> chosen_rows(const CaptureFolder& capture, const RenderOptions& options) {
  std::vector<int64_t> rows;
  if (capture.rows.empty()) throw IoError((capture.path / "frames.csv").string() + ": has no frame");
  for (int64_t row = 0; row < static_cast<int64_t>(capture.rows.size()); ++row) {
    const int64_t index = capture.rows[row].index;
    if (index < options.first || (options.frames >= 0 && index - options.first >= options.frames)) continue;
    if ((index - options.first) % options.every == 0) rows.push_back(row);
  }
  if (rows.empty())
    throw IoError((capture.path / "frames.csv").string() +
                  format(": none of its frames, %lld to %lld, is asked for; see --first, --frames and --every",
                         static_cast<long long>(capture.rows.front().index),
                         static_cast<long long>(capture.rows.back().index)));
  return rows;
}

Vector3d median_root(const Clip& clip) {
  const int root = std::max(0, index_of(clip.capture.joints.names, clip.capture.actor.skeleton.bones[0].name));
  std::vector<double> places[3];
  for (int64_t row = 0; row < static_cast<int64_t>(clip.capture.rows.size()); ++row) {
    const std::vector<Vector3d> joints = clip.joints(row);
    if (joints.empty()) continue;
    for (int k = 0; k < 3; ++k) places[k].push_back(joints[root][k]);
  }
  if (places[0].empty())
    throw IoError((clip.capture.path / "frames.csv").string() + ": nobody was tracked in any frame");
  return {median(places[0]), median(places[1]), median(places[2])};
}

}  // namespace

std::vector<Vector3d> Clip::joints(int64_t row) const {
  std::vector<Vector3d> points;
  if (!tracked(row)) return points;
  const std::vector<float> joints = captured_joints(capture, row);
  for (size_t i = 0; i < joints.size(); i += 3)
    points.push_back(Eigen::Map<const Eigen::Vector3f>(&joints[i]).cast<double>());
  const bool known = std::all_of(points.begin(), points.end(), [](const Vector3d& point) { return point.allFinite(); });
  return known ? points : std::vector<Vector3d>();
}

std::vector<float> Clip::vertices(int64_t row) {
  return tracked(row) ? captured_vertices(capture, row) : std::vector<float>();
}

Clip open_clip(const RenderOptions& options) {
  const bool own = options.camera.empty() && !options.needs_video();  // the video has distortion
  const std::string camera = own ? own_camera_file(options.capture) : options.camera;
  Clip clip{open_capture(options.capture, options.actor, camera, {})};
  if (!clip.capture.vertices)
    throw IoError((fs::path(options.capture) / "vertices.pc2").string() +
                  ": is missing; `livecap capture` writes it beside report.json");
  clip.rows = chosen_rows(clip.capture, options);
  require_rows(clip.capture, clip.rows, "vertices.pc2", clip.capture.vertices->n_samples(), "samples");
  require_rows(clip.capture, clip.rows, "joints.csv", clip.capture.joints.frames.size(), "rows");
  const bool uses_angles = options.is_about_person() || options.style == "displacement";
  if (uses_angles && !clip.capture.angles.empty())
    require_rows(clip.capture, clip.rows, "angles.csv", clip.capture.angles.frames.size(), "rows");
  if (!options.is_about_person()) return clip;
  clip.place_mm = median_root(clip);
  clip.floor = find_floor(clip.capture).floor;
  return clip;
}

}  // namespace livecap::render
