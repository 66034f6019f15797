#include "eval/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "actor/actor.h"
#include "base/log.h"
#include "base/text.h"
#include "eval/joint_names.h"
#include "eval/mask_raster.h"
#include "eval/sequence_files.h"
#include "export/pc2.h"
#include "image/image_io.h"
#include "livecap/camera.h"
#include "livecap/error.h"
#include "synth/synth.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// What the capture folder says about itself and the files it names.
struct Captured {
  std::vector<FrameRow> rows;
  Pc2Reader vertices;
  JointTrack joints;
  std::vector<int32_t> triangles;
  Camera camera;
};

struct Truth {
  std::optional<Pc2Reader> vertices;
  JointTrack joints;
  fs::path masks;  // empty: none
};

// All distances of the judged frames, mm.
struct Samples {
  std::vector<double> iou;
  std::vector<double> vertex;
  std::vector<double> vertex_aligned;
  std::vector<double> joint;
  std::vector<double> joint_aligned;
  std::vector<std::vector<double>> per_joint;  // [n_pairs]
};

std::vector<float> read_sample(Pc2Reader& file, int64_t sample) {
  std::vector<float> positions(3 * static_cast<size_t>(file.n_points()));
  file.read(static_cast<int>(sample), positions);
  return positions;
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? kNaN : summarize(values).mean;
}

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

// metres, glTF frame -> mm, camera frame.
std::vector<float> to_camera_mm(std::vector<float> positions) {
  for (size_t i = 0; i + 2 < positions.size(); i += 3) {
    positions[i] *= 1000;
    positions[i + 1] *= -1000;
    positions[i + 2] *= -1000;
  }
  return positions;
}

Actor load_actor_named(const std::string& name, double height_mm) {
  const std::string prefix = "builtin:";
  if (name.rfind(prefix, 0) != 0) return load_actor(name, height_mm);
  return load_actor_bytes(
      make_builtin_actor_glb(name.substr(prefix.size()), height_mm > 0 ? height_mm : kBuiltinHeightMm), name);
}

// Field `name` of report.json's options; `fallback` when it is missing or null.
template <typename T>
T report_option(const nlohmann::json& report, const char* name, T fallback) {
  const auto options = report.find("options");
  if (options == report.end() || !options->is_object()) return fallback;
  const auto value = options->find(name);
  if (value == options->end() || value->is_null()) return fallback;
  try {
    return value->get<T>();
  } catch (const nlohmann::json::exception&) {
    return fallback;
  }
}

// The file, or for a capture that was given a field of view only: that, at the size of the true masks.
Camera load_camera_of(const EvalOptions& options, const nlohmann::json& report) {
  const std::string file = options.camera.empty() ? report_option<std::string>(report, "camera", "") : options.camera;
  if (!file.empty()) return load_camera(file);
  const double fov_deg = report_option<double>(report, "fov_deg", 0);
  const fs::path masks = options.truth / "masks";
  if (fov_deg > 0 && fs::is_directory(masks)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(masks)) {
      const ImageGray mask = read_image_gray(entry.path());
      return camera_from_fov(mask.width, mask.height, fov_deg);
    }
  }
  throw IoError((options.capture / "report.json").string() + ": field \"options.camera\" is missing; give --camera");
}

Captured load_captured(const EvalOptions& options) {
  const fs::path report_path = options.capture / "report.json";
  const nlohmann::json report = nlohmann::json::parse(read_file(report_path), nullptr, false);
  if (!report.is_object()) throw IoError(report_path.string() + ": is not a JSON object");

  const std::string actor_name =
      options.actor.empty() ? report_option<std::string>(report, "actor", "") : options.actor;
  if (actor_name.empty()) throw IoError(report_path.string() + ": field \"options.actor\" is missing; give --actor");
  const Actor actor = load_actor_named(actor_name, report_option<double>(report, "height_mm", 0));
  Captured captured{read_frames_csv(options.capture / "frames.csv"), Pc2Reader(options.capture / "vertices.pc2"),
                    read_joints_csv(options.capture / "joints.csv"), actor.mesh.triangles,
                    load_camera_of(options, report)};
  if (captured.vertices.n_points() != actor.n_vertices()) {
    throw IoError((options.capture / "vertices.pc2").string() + format(": has %d points, the actor %s has %d",
                                                                       captured.vertices.n_points(), actor_name.c_str(),
                                                                       actor.n_vertices()));
  }
  return captured;
}

Truth load_truth(const fs::path& folder, int n_vertices) {
  if (!fs::is_directory(folder)) throw IoError(folder.string() + ": is not a folder");
  Truth truth;
  if (fs::exists(folder / "vertices.pc2")) {
    truth.vertices.emplace(folder / "vertices.pc2");
    if (truth.vertices->n_points() != n_vertices) {
      throw IoError((folder / "vertices.pc2").string() +
                    format(": has %d points, the capture has %d", truth.vertices->n_points(), n_vertices));
    }
  }
  if (fs::exists(folder / "joints.json")) truth.joints = read_joints_json(folder / "joints.json");
  if (fs::is_directory(folder / "masks")) truth.masks = folder / "masks";
  if (!truth.vertices && truth.joints.empty() && truth.masks.empty()) {
    throw IoError(folder.string() + ": holds none of vertices.pc2, joints.json, masks/");
  }
  return truth;
}

// What the truth knows about one frame.
struct TruthFrame {
  std::vector<float> vertices;  // empty: nobody, or not known
  std::vector<float> joints;
  ImageGray mask;
  bool person = false;
};

TruthFrame truth_frame(Truth& truth, int64_t index, const Camera& camera) {
  TruthFrame frame;
  if (truth.vertices && index < truth.vertices->n_samples()) {
    frame.vertices = read_sample(*truth.vertices, index);
    if (!all_finite(frame.vertices)) frame.vertices.clear();
  }
  if (index < static_cast<int64_t>(truth.joints.frames.size())) frame.joints = truth.joints.frames[index];
  const fs::path mask = truth.masks / format("%06lld.png", static_cast<long long>(index));
  if (!truth.masks.empty() && fs::exists(mask)) {
    frame.mask = read_image_gray(mask);
    if (frame.mask.width != camera.width || frame.mask.height != camera.height) {
      throw IoError(mask.string() + format(": is %dx%d, the camera %dx%d", frame.mask.width, frame.mask.height,
                                           camera.width, camera.height));
    }
  }
  frame.person = truth.vertices          ? !frame.vertices.empty()
                 : !truth.joints.empty() ? !frame.joints.empty()
                                         : mask_has_person(frame.mask);
  return frame;
}

void judge_vertices(const std::vector<float>& captured, const TruthFrame& truth, FrameEval& frame, Samples& samples) {
  if (truth.vertices.empty() || captured.empty()) return;
  std::vector<float> truth_mm = to_camera_mm(truth.vertices);
  const std::vector<double> direct = point_distances(captured, truth_mm);
  const std::vector<double> aligned = translation_aligned_distances(captured, truth_mm);
  frame.vertex_mm = mean_of(direct);
  frame.vertex_aligned_mm = mean_of(aligned);
  append(samples.vertex, direct);
  append(samples.vertex_aligned, aligned);
}

void judge_joints(const std::vector<float>& captured, const TruthFrame& truth, const std::vector<JointPair>& pairs,
                  FrameEval& frame, Samples& samples) {
  if (truth.joints.empty() || captured.empty() || pairs.size() < 3) return;
  std::vector<float> ours;
  std::vector<float> theirs;
  for (const JointPair& pair : pairs) {
    ours.insert(ours.end(), &captured[3 * pair.captured], &captured[3 * pair.captured] + 3);
    theirs.insert(theirs.end(), &truth.joints[3 * pair.truth], &truth.joints[3 * pair.truth] + 3);
  }
  ours = to_camera_mm(std::move(ours));
  theirs = to_camera_mm(std::move(theirs));
  const std::vector<double> direct = point_distances(ours, theirs);
  const std::vector<double> aligned = similarity_aligned_distances(ours, theirs);
  frame.joint_mm = mean_of(direct);
  frame.joint_aligned_mm = mean_of(aligned);
  append(samples.joint, direct);
  append(samples.joint_aligned, aligned);
  for (size_t k = 0; k < pairs.size(); ++k) samples.per_joint[k].push_back(aligned[k]);
}

}  // namespace

EvalReport evaluate(const EvalOptions& options) {
  Captured captured = load_captured(options);
  Truth truth = load_truth(options.truth, captured.vertices.n_points());
  const std::vector<JointPair> pairs = match_joints(captured.joints.names, truth.joints.names);
  if (!truth.joints.empty() && pairs.size() < 3) {
    log_warning(
        (options.truth / "joints.json").string() +
        format(": only %zu joints have a known name (LiveCap, Mixamo, UE); joint errors are left out", pairs.size()));
  }
  Samples samples;
  samples.per_joint.resize(pairs.size());

  EvalReport report;
  report.n_frames = static_cast<int64_t>(captured.rows.size());
  for (int64_t row = 0; row < report.n_frames; ++row) {
    FrameEval frame;
    frame.index = captured.rows[row].index;
    frame.status = captured.rows[row].status;
    frame.tracked = frame.status == "ok" || frame.status == "initialized";
    frame.iou = frame.vertex_mm = frame.vertex_aligned_mm = frame.joint_mm = frame.joint_aligned_mm = kNaN;
    const TruthFrame expected = truth_frame(truth, frame.index, captured.camera);
    if (!expected.person) {
      report.n_invented += frame.tracked;
      continue;
    }

    std::vector<float> vertices;
    if (row < captured.vertices.n_samples()) vertices = to_camera_mm(read_sample(captured.vertices, row));
    if (!all_finite(vertices)) vertices.clear();
    report.n_person += 1;
    report.n_tracked += frame.tracked;
    report.n_without_result += vertices.empty();

    if (!expected.mask.empty()) {
      frame.iou = vertices.empty()
                      ? 0
                      : mask_iou(render_silhouette(vertices, captured.triangles, captured.camera), expected.mask);
      samples.iou.push_back(frame.iou);
    }
    judge_vertices(vertices, expected, frame, samples);
    if (row < static_cast<int64_t>(captured.joints.frames.size())) {
      judge_joints(captured.joints.frames[row], expected, pairs, frame, samples);
    }
    report.frames.push_back(std::move(frame));
  }
  report.n_lost = report.n_person - report.n_tracked;
  report.iou = summarize(std::move(samples.iou));
  report.vertex_mm = summarize(std::move(samples.vertex));
  report.vertex_aligned_mm = summarize(std::move(samples.vertex_aligned));
  report.joint_mm = summarize(std::move(samples.joint));
  report.joint_aligned_mm = summarize(std::move(samples.joint_aligned));
  for (size_t k = 0; k < pairs.size(); ++k) {
    report.joints_aligned_mm.emplace_back(pairs[k].name, mean_of(samples.per_joint[k]));
  }
  return report;
}

}  // namespace livecap
