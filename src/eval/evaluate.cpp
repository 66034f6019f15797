#include "eval/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/joined.h"
#include "base/log.h"
#include "base/text.h"
#include "eval/body_points.h"
#include "eval/joint_judge.h"
#include "eval/mask_raster.h"
#include "eval/other_mesh.h"
#include "eval/pose_metrics.h"
#include "eval/true_mesh.h"
#include "eval/truth_folder.h"
#include "image/mask_iou.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Shares of the judged frames in which each joint angle is at one of its limits.
void judge_limits(const CaptureFolder& capture, EvalReport& report) {
  report.at_limit = kNaN;
  constexpr double kDeg = 180 / std::numbers::pi;
  int64_t n_all = 0, n_at_limit = 0;
  for (const Dof& dof : capture.actor.skeleton.dofs) {
    const auto name = std::find(capture.angles.names.begin(), capture.angles.names.end(), dof.name);
    if (name == capture.angles.names.end()) continue;
    const size_t column = name - capture.angles.names.begin();
    int64_t n = 0, here = 0;
    for (const FrameEval& frame : report.frames) {
      if (frame.row >= static_cast<int64_t>(capture.angles.frames.size())) continue;
      const std::vector<double>& angles = capture.angles.frames[frame.row];
      if (angles.empty()) continue;
      ++n;
      here += at_limit(angles[column], kDeg * dof.min_rad, kDeg * dof.max_rad);
    }
    if (here > 0) report.angles_at_limit.emplace_back(dof.name, static_cast<double>(here) / static_cast<double>(n));
    n_all += n;
    n_at_limit += here;
  }
  if (n_all > 0) report.at_limit = static_cast<double>(n_at_limit) / static_cast<double>(n_all);
}

// Says which joints are not judged, though the truth has them or seems to.
void warn_of_joints(const EvalOptions& options, size_t n_pairs, const std::vector<std::string>& not_captured) {
  const std::string none = n_pairs < kFewestJoints ? "; joint errors are left out" : "";
  if (n_pairs + not_captured.size() < kFewestJoints) {
    log_warning((options.truth / "joints.json").string() +
                format(": only %zu joints have a known name (LiveCap, Mixamo, UE)", n_pairs + not_captured.size()) +
                none);
  } else if (!not_captured.empty()) {
    log_warning((options.capture / "joints.csv").string() + ": has no columns joint_<name>_x, _y, _z of " +
                joined(not_captured) + ", which are not judged" + none);
  }
}

// Frames without a row are not judged, which is for the reader to know.
void warn_of_gaps(const CaptureFolder& capture) {
  int64_t n = 0;
  for (size_t i = 1; i < capture.rows.size(); ++i)
    n += std::max<int64_t>(0, capture.rows[i].index - capture.rows[i - 1].index - 1);
  if (n > 0)
    log_warning(capture.path.string() + format(": has no row for %lld of the frames from its first to its last, which "
                                               "are not judged; a row with empty cells is a frame without a result",
                                               static_cast<long long>(n)));
}

// Errors of such a size say nothing of the capture.
void warn_of_unit(const EvalOptions& options, double times_as_far) {
  constexpr double kMuch = 20, kMillimetres = 300;
  if (!(times_as_far >= kMuch)) return;
  log_warning((options.capture / "joints.csv").string() +
              format(": its joints are %.0f times as far from the camera as the true ones: are these %s? metres are "
                     "expected",
                     times_as_far, times_as_far < kMillimetres ? "cm" : "mm"));
}

double view_iou(const std::vector<float>& vertices_mm, const CaptureFolder& capture, const Camera& camera,
                const ImageGray& mask) {
  if (vertices_mm.empty()) return 0;
  return mask_iou(render_silhouette(vertices_mm, capture.actor.mesh.triangles, camera), mask);
}

}  // namespace

EvalReport evaluate(const EvalOptions& options) {
  CaptureFolder capture = open_capture(options.capture, options.actor, options.camera, options.truth / "masks");
  const TrueMesh true_mesh(options.truth, options.truth_actor, capture.actor);
  const std::optional<Actor>& truth_actor = true_mesh.actor();
  const bool other_mesh = true_mesh.is_other();
  TruthFolder truth = open_truth(options.truth, capture.vertices ? true_mesh.n_vertices() : 0);
  const auto true_on_actor = other_mesh ? true_vertices_on(capture.actor, *truth_actor, true_mesh.overlay())
                                        : std::vector<meshing::SurfacePoint>();
  const std::vector<JointPair> pairs = match_joints(capture.joints.names, truth.joints.names);
  warn_of_gaps(capture);
  if (!truth.joints.empty())
    warn_of_joints(options, pairs.size(), joints_not_captured(capture.joints.names, truth.joints.names));

  if (!capture.vertices && !options.views.empty())
    throw IoError(options.capture.string() + ": has no vertices.pc2, which further views need");
  EvalReport report;
  report.run = capture.run;
  report.other_mesh = other_mesh;
  report.speed = capture.speed;
  report.video_fps = capture.fps;
  report.n_frames = static_cast<int64_t>(capture.rows.size());
  JointJudge joints(pairs, capture.fps), body_points(pairs, capture.fps);
  std::optional<CarriedJoints> true_joints;
  if (other_mesh) true_joints.emplace(capture.actor, *truth_actor, true_mesh.overlay(), pairs);
  NetworkJudge network(capture, truth.joints.names);
  VertexErrors vertex_errors;
  JitterMeter vertex_jitter(capture.fps), vertex_jitter_centred(capture.fps, true);
  const std::vector<uint8_t>& labels = capture.actor.labels;
  const auto is_loose = [&](int vertex) { return is_loose_garment(labels[vertex]); };
  std::vector<std::vector<double>> view_ious(options.views.size());
  std::vector<double> ious, surface, at_true_vertices;
  std::vector<bool> person, tracked;

  for (int64_t row = 0; row < report.n_frames; ++row) {
    FrameEval frame;
    frame.index = capture.rows[row].index;
    frame.row = row;
    frame.status = capture.rows[row].status;
    frame.tracked = capture.rows[row].tracked();
    for (double* value : {&frame.iou, &frame.vertex_mm, &frame.vertex_aligned_mm, &frame.loose_aligned_mm,
                          &frame.joint_mm, &frame.joint_aligned_mm, &frame.network_aligned_mm}) {
      *value = kNaN;
    }
    TruthFrame expected = truth_frame(truth, frame.index, capture.camera);
    if (row > 0 && capture.rows[row].pts_ms - capture.rows[row - 1].pts_ms > 1500 / capture.fps) {
      vertex_jitter.add({}, {});  // frames are missing in the video: no motion is known across the gap
      vertex_jitter_centred.add({}, {});
      joints.skip();
    }
    person.push_back(expected.person);
    tracked.push_back(frame.tracked);
    if (!expected.person) {
      report.n_invented += frame.tracked;
      vertex_jitter.add({}, {});
      vertex_jitter_centred.add({}, {});
      joints.skip();
      continue;
    }
    const std::vector<float> vertices = captured_vertices(capture, row);
    const std::vector<float> true_surface = expected.vertices_mm;
    expected.vertices_mm = true_mesh.of_captured(true_surface);
    if (other_mesh && !vertices.empty() && !true_surface.empty()) {
      const auto distances =
          translation_aligned_distances(resample(true_on_actor, capture.actor.mesh.triangles, vertices), true_surface);
      at_true_vertices.insert(at_true_vertices.end(), distances.begin(), distances.end());
    }
    if (truth_actor && !vertices.empty() && !true_surface.empty()) {
      const auto distances =
          surface_distances(vertices, expected.vertices_mm, true_surface, truth_actor->mesh.triangles);
      surface.insert(surface.end(), distances.begin(), distances.end());
    }
    report.n_person += 1;
    report.n_tracked += frame.tracked;
    const std::vector<float> row_joints = captured_joints(capture, row);
    report.n_without_result += capture.vertices ? vertices.empty() : row_joints.empty();

    if (capture.vertices && !expected.mask.empty()) {
      frame.iou = view_iou(vertices, capture, capture.camera, expected.mask);
      ious.push_back(frame.iou);
    }
    for (size_t v = 0; capture.vertices && v < options.views.size(); ++v) {
      const ExtraView& view = options.views[v];
      const ImageGray mask = read_mask(view.masks, frame.index, view.camera);
      if (!mask.empty()) view_ious[v].push_back(view_iou(to_view(view, vertices), capture, view.camera, mask));
    }
    vertex_jitter.add(vertices, expected.vertices_mm);
    vertex_jitter_centred.add(vertices, expected.vertices_mm);
    if (!vertices.empty() && !expected.vertices_mm.empty()) {
      const std::vector<double> direct = point_distances(vertices, expected.vertices_mm);
      const std::vector<double> aligned = translation_aligned_distances(vertices, expected.vertices_mm);
      frame.vertex_mm = mean_of(direct);
      frame.vertex_aligned_mm = mean_of(aligned);
      std::vector<double> loose;
      for (size_t i = 0; i < aligned.size(); ++i) {
        if (is_loose(static_cast<int>(i))) loose.push_back(aligned[i]);
      }
      frame.loose_aligned_mm = mean_of(loose);
      vertex_errors.add(direct, aligned);
    }
    joints.add(row_joints, expected.joints_mm, frame);
    if (true_joints) {
      const std::vector<Eigen::Isometry3d> bones = captured_bones(capture, row, row_joints);
      FrameEval unused;
      if (!bones.empty()) body_points.add(true_joints->at(row_joints, bones), expected.joints_mm, unused);
    }
    network.add(expected.joints_mm, frame);
    report.n_arms_exchanged += frame.arms_exchanged;
    report.n_legs_exchanged += frame.legs_exchanged;
    report.n_limb_inside += frame.limb_inside;
    report.frames.push_back(std::move(frame));
  }
  if (report.n_person == 0) {
    throw IoError(options.truth.string() +
                  format(": has nobody in any of the %lld captured frames", static_cast<long long>(report.n_frames)));
  }
  report.n_lost = report.n_person - report.n_tracked;
  report.losses = count_losses(person, tracked);
  report.iou = summarize(std::move(ious));
  report.surface_mm = summarize(std::move(surface));
  for (size_t v = 0; v < options.views.size(); ++v) {
    if (view_ious[v].empty()) {
      throw IoError(options.views[v].masks.string() + ": holds no mask of a captured frame, expected 000000.png ...");
    }
    report.views.push_back({options.views[v].name, summarize(view_ious[v])});
  }
  if (vertex_errors.n_frames() > 0) {
    report.vertex_mm = vertex_errors.direct();
    report.vertex_aligned_mm = vertex_errors.aligned();
    report.true_vertex_aligned_mm = other_mesh ? summarize(std::move(at_true_vertices)) : report.vertex_aligned_mm;
    report.loose_mm = vertex_errors.direct(is_loose);
    report.loose_aligned_mm = vertex_errors.aligned(is_loose);
    report.labels = errors_by_label(vertex_errors, labels);
    report.vertex_mean_mm = vertex_errors.mean_aligned();
  }
  report.vertex_jitter = vertex_jitter.result();
  report.vertex_jitter_centred = vertex_jitter_centred.result();
  joints.finish(report);
  warn_of_unit(options, joints.times_as_far());
  report.body_point_mm = report.joint_mm;
  report.body_point_aligned_mm = report.joint_aligned_mm;
  report.body_points_aligned_mm = report.joints_aligned_mm;
  if (true_joints) {
    EvalReport of_points;
    body_points.finish(of_points);
    report.body_point_mm = of_points.joint_mm;
    report.body_point_aligned_mm = of_points.joint_aligned_mm;
    report.body_points_aligned_mm = of_points.joints_aligned_mm;
  }
  network.finish(report);
  judge_limits(capture, report);
  return report;
}

}  // namespace livecap
