#include "eval/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/joined.h"
#include "base/log.h"
#include "base/text.h"
#include "eval/joint_judge.h"
#include "eval/pose_metrics.h"
#include "eval/silhouette_judge.h"
#include "eval/true_mesh.h"
#include "eval/truth_folder.h"
#include "eval/vertex_judge.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Shares of the judged frames in which each joint angle is at one of its limits.
void judge_limits(const CaptureFolder& capture, EvalReport& report) {
  report.at_limit = std::numeric_limits<double>::quiet_NaN();
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

// A truth that ends early, or lacks masks, does not say that nobody is there.
void warn_of_incomplete(const CaptureFolder& capture, const TruthFolder& truth) {
  const auto n_joints = static_cast<int64_t>(truth.joints.frames.size());
  int64_t n_unknown = 0, first_unknown = 0, n_without_joints = 0;
  for (const FrameRow& row : capture.rows) {
    n_without_joints += row.index >= n_joints;
    if (tells_of(truth, row.index)) continue;
    if (n_unknown++ == 0) first_unknown = row.index;
  }
  if (n_unknown > 0)
    log_warning(
        best_truth(truth).string() +
        format(": has no entry for %lld of the %zu captured frames, the first of them %lld; they count as frames "
               "without a person",
               static_cast<long long>(n_unknown), capture.rows.size(), static_cast<long long>(first_unknown)));
  if (truth.vertices && !truth.joints.empty() && n_without_joints > 0)
    log_warning((truth.path / "joints.json").string() +
                format(": has %lld frames, %lld of the captured ones come after them: their joints are not judged",
                       static_cast<long long>(n_joints), static_cast<long long>(n_without_joints)));
}

// Was this frame of the video to be captured, as far as the capture says?
bool was_asked_for(const CaptureFolder& capture, int64_t index) {
  return index >= capture.first && (capture.frames < 0 || index - capture.first < capture.frames);
}

// Counts the frames with a person that have no row, anywhere in the truth. They are not judged, which is for the reader
// to know where nobody asked for it.
void find_gaps(const EvalOptions& options, const CaptureFolder& capture, TruthFolder& truth, EvalReport& report) {
  int64_t n_missing = 0;
  size_t row = 0;
  for (int64_t index = 0, n = n_true_frames(truth); index < n; ++index) {
    require_going_on(options);  // true masks may have to be looked at
    while (row < capture.rows.size() && capture.rows[row].index < index) ++row;
    const bool has_row = row < capture.rows.size() && capture.rows[row].index == index;
    if (has_row || !has_person(truth, index, capture.camera)) continue;
    ++(was_asked_for(capture, index) ? n_missing : report.n_not_asked);
  }
  report.n_true_person = report.n_person + n_missing + report.n_not_asked;
  if (n_missing > 0)
    log_warning(
        capture.path.string() +
        format(": has no row for %lld of the %lld frames in which the truth has a person, which are not judged; "
               "a row with empty cells is a frame without a result",
               static_cast<long long>(n_missing), static_cast<long long>(report.n_true_person)));
}

// Errors of such a size say nothing of the capture. One side is much farther away than the other, or behind the camera.
void warn_of_places(const EvalOptions& options, const JointJudge& joints) {
  constexpr double kMuch = 20, kMillimetres = 300;
  const JointJudge::Place captured = joints.captured_place(), truth = joints.true_place();
  const std::string ours = (options.capture / "joints.csv").string(), theirs = (options.truth / "joints.json").string();
  const auto too_far = [](const std::string& file, double times, const char* than) {
    if (times >= kMuch && std::isfinite(times))
      log_warning(file + format(": its joints are %.0f times as far from the camera as the %s ones: are these %s? "
                                "metres are expected",
                                times, than, times < kMillimetres ? "cm" : "mm"));
  };
  too_far(ours, captured.away_mm / truth.away_mm, "true");
  too_far(theirs, truth.away_mm / captured.away_mm, "captured");
  for (const auto& [file, place] : {std::pair{ours, captured}, {theirs, truth}}) {
    if (place.z_mm < 0)
      log_warning(file +
                  ": its joints are behind the camera: z is negative before it; of OpenCV's axes write "
                  "(x, -y, -z)");
  }
}

// Motion is told by times: wrong ones look like another frame rate, or like none.
void warn_of_times(const CaptureFolder& capture) {
  constexpr double kFewest = 1, kMost = 1000;
  std::error_code ignored;
  const bool has_frames = std::filesystem::exists(capture.path / "frames.csv", ignored);
  const std::string file = (capture.path / (has_frames ? "frames.csv" : "joints.csv")).string();
  if (!(capture.fps >= kFewest && capture.fps <= kMost))
    log_warning(file + format(": pts_ms says %.4g frames a second, expected %g to %g: is it in milliseconds?",
                              capture.fps, kFewest, kMost));
  for (size_t row = 1; row < capture.rows.size(); ++row) {
    if (!(capture.rows[row].pts_ms < capture.rows[row - 1].pts_ms)) continue;
    log_warning(file + format(": line %zu: pts_ms falls from %.10g to %.10g: frames must follow each other in time",
                              row + 2, capture.rows[row - 1].pts_ms, capture.rows[row].pts_ms));
    return;
  }
}

// Frames are missing in the video before this row: no motion is known across the gap.
bool comes_after_gap(const CaptureFolder& capture, int64_t row) {
  return row > 0 && capture.rows[row].pts_ms - capture.rows[row - 1].pts_ms > 1500 / capture.fps;
}

}  // namespace

void require_going_on(const EvalOptions& options) {
  if (options.go_on && !options.go_on()) throw Error("interrupted");
}

EvalReport evaluate(const EvalOptions& options) {
  CaptureFolder capture = open_capture(options.capture, options.actor, options.camera, options.truth / "masks");
  const TrueMesh true_mesh(options.truth, options.truth_actor, capture.actor);
  TruthFolder truth = open_truth(options.truth, capture.vertices ? true_mesh.n_vertices() : 0);
  VertexJudge surface(capture.actor, true_mesh, capture.fps);
  const std::vector<JointPair> pairs = match_joints(capture.joints.names, truth.joints.names);
  if (!truth.joints.empty())
    warn_of_joints(options, pairs.size(), joints_not_captured(capture.joints.names, truth.joints.names));
  warn_of_incomplete(capture, truth);
  if (!capture.vertices && !options.views.empty())
    throw IoError(options.capture.string() + ": has no vertices.pc2, which further views need");
  SilhouetteJudge silhouettes(capture, options.views);
  JointJudge joints(pairs, capture.fps);
  BodyPointJudge body_points(capture, true_mesh, pairs);
  NetworkJudge network(capture, truth.joints.names);

  EvalReport report;
  report.run = capture.run;
  report.speed = capture.speed;
  report.video_fps = capture.fps;
  report.n_frames = static_cast<int64_t>(capture.rows.size());
  std::vector<bool> person, tracked;
  for (int64_t row = 0; row < report.n_frames; ++row) {
    require_going_on(options);
    FrameEval frame;
    frame.index = capture.rows[row].index;
    frame.row = row;
    frame.status = capture.rows[row].status;
    frame.tracked = capture.rows[row].tracked();
    const TruthFrame expected = truth_frame(truth, frame.index, capture.camera);
    person.push_back(expected.person);
    tracked.push_back(frame.tracked);
    if (!expected.person || comes_after_gap(capture, row)) {
      surface.skip();
      joints.skip();
    }
    if (!expected.person) {
      report.n_invented += frame.tracked;
      continue;
    }
    const std::vector<float> vertices = captured_vertices(capture, row), row_joints = captured_joints(capture, row);
    report.n_person += 1;
    report.n_tracked += frame.tracked;
    report.n_without_result += capture.vertices ? vertices.empty() : row_joints.empty();
    silhouettes.add(vertices, expected.mask, frame);
    surface.add(vertices, expected.vertices_mm, frame);
    joints.add(row_joints, expected.joints_mm, frame);
    body_points.add(row, row_joints, expected.joints_mm);
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
  find_gaps(options, capture, truth, report);
  report.n_lost = report.n_person - report.n_tracked;
  report.losses = count_losses(person, tracked);
  silhouettes.finish(report);
  surface.finish(report);
  joints.finish(report);
  warn_of_places(options, joints);
  warn_of_times(capture);
  body_points.finish(report);
  network.finish(report);
  judge_limits(capture, report);
  return report;
}

}  // namespace livecap
