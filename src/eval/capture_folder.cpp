#include "eval/capture_folder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/floor_plane.h"
#include "base/is_there.h"
#include "base/text.h"
#include "eval/metrics.h"
#include "image/image_io.h"
#include "livecap/capture.h"
#include "livecap/error.h"
#include "synth/named_actor.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

constexpr double kAssumedFps = 30;

// Field `name` of a JSON object; `fallback` when it is missing, null or of another type.
template <typename T>
T field(const nlohmann::json& object, const char* name, T fallback) {
  if (!object.is_object()) return fallback;
  const auto value = object.find(name);
  if (value == object.end() || value->is_null()) return fallback;
  try {
    return value->get<T>();
  } catch (const nlohmann::json::exception&) {
    return fallback;
  }
}

// The file, or for a capture that was given a field of view only, or never got as far as its report: the folder's own
// copy, which has no distortion; a folder without one: the field of view at the size of the true masks.
Camera load_camera_of(const fs::path& report_path, const std::string& named, const nlohmann::json& options,
                      const fs::path& masks) {
  std::error_code ignored;
  const std::string file = named.empty() ? field<std::string>(options, "camera", "") : named;
  if (named.empty() && !file.empty() && !fs::exists(file, ignored))
    throw IoError(file + ": no such file; " + report_path.string() + " names it, --camera (and --video) say otherwise");
  if (named.empty()) require_no_pipe(file);
  if (!file.empty()) return load_camera(file);
  if (const std::string own = own_camera_file(report_path.parent_path()); !own.empty()) return load_camera(own);
  const double fov_deg = field<double>(options, "fov_deg", 0);
  if (fov_deg > 0 && fs::is_directory(masks, ignored)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(masks, ignored)) {
      const ImageGray mask = read_image_gray(entry.path());
      return camera_from_fov(mask.width, mask.height, fov_deg);
    }
  }
  throw IoError(not_named(report_path, "camera"));
}

// The frames of a folder without frames.csv.
std::vector<FrameRow> rows_of_joints(const JointTrack& joints, const fs::path& path) {
  if (joints.rows.size() < joints.frames.size())
    throw IoError(path.string() + ": there is no column \"index\", which is needed without frames.csv");
  for (size_t i = 1; i < joints.rows.size(); ++i) {
    const int64_t before = joints.rows[i - 1].index, index = joints.rows[i].index;
    if (index <= before)
      throw IoError(path.string() + format(": line %zu: index %lld does not follow %lld", i + 2,
                                           static_cast<long long>(index), static_cast<long long>(before)));
  }
  return joints.rows;
}

std::vector<FrameRow> read_rows(const fs::path& folder, const JointTrack& joints) {
  const fs::path frames_csv = folder / "frames.csv", joints_csv = folder / "joints.csv";
  std::error_code ignored;
  std::vector<FrameRow> rows =
      fs::exists(frames_csv, ignored) ? read_frames_csv(frames_csv) : rows_of_joints(joints, joints_csv);
  for (size_t i = 0; i < std::min(rows.size(), joints.rows.size()); ++i) {
    if (rows[i].index != joints.rows[i].index)
      throw IoError(joints_csv.string() + format(": line %zu is of frame %lld, in frames.csv of frame %lld", i + 2,
                                                 static_cast<long long>(joints.rows[i].index),
                                                 static_cast<long long>(rows[i].index)));
  }
  // Without any time stamp the frames' numbers still tell where some are left out.
  if (std::all_of(rows.begin(), rows.end(), [](const FrameRow& row) { return std::isnan(row.pts_ms); })) {
    for (FrameRow& row : rows) row.pts_ms = 1000 * static_cast<double>(row.index) / kAssumedFps;
  }
  return rows;
}

// Of the rows, by the median step of their time stamps.
double frames_per_second(const std::vector<FrameRow>& rows) {
  std::vector<double> steps_ms;
  for (size_t i = 1; i < rows.size(); ++i) steps_ms.push_back(rows[i].pts_ms - rows[i - 1].pts_ms);
  const double step_ms = summarize(steps_ms).median;
  return step_ms > 0 ? 1000 / step_ms : kAssumedFps;
}

// What a reader of a table has to know about how a capture was made.
std::string describe(const nlohmann::json& options) {
  std::string text;
  const auto add = [&](const std::string& words) { text += (text.empty() ? "" : ", ") + words; };
  if (const std::string model = field<std::string>(options, "model", "full"); model != "full") add(model);
  if (!field(options, "surface", true)) add("pose only");
  if (const double rigidity = field(options, "rigidity", 0.0); rigidity > 0) add(format("rigidity %g", rigidity));
  for (const std::string& name : field(options, "without", std::vector<std::string>())) add("without " + name);
  if (field(options, "smooth", false)) add("smoothed");
  if (!field<std::string>(options, "floor", "").empty()) add("floor given");
  const int64_t kUsual = CaptureOptions{}.learn_frames;
  if (const int64_t n = field(options, "learn_frames", kUsual); n != kUsual)
    add(n == 0 ? "learned on the way" : format("%lld frames looked at beforehand", static_cast<long long>(n)));
  return text;
}

CaptureSpeed speed_of(const nlohmann::json& report, const std::vector<FrameRow>& rows) {
  std::vector<double> latency_ms;
  for (const FrameRow& row : rows) {
    if (row.tracked()) latency_ms.push_back(row.latency_ms);
  }
  const Summary summary = summarize(latency_ms);
  return {field(report, "fps", kNaN), field(report, "latency_ms", kNaN), summary.n > 0 ? summary.p95 : kNaN};
}

void require_points(const Pc2Reader& vertices, const fs::path& file, const std::string& actor_name, int expected) {
  if (vertices.n_points() == expected) return;
  throw IoError(file.string() +
                format(": has %d points, the actor %s has %d", vertices.n_points(), actor_name.c_str(), expected));
}

}  // namespace

std::string not_named(const fs::path& report_path, const std::string& what) {
  std::error_code ignored;
  const bool exists = fs::exists(report_path, ignored);
  return report_path.string() + (exists ? ": field \"options." + what + "\" is missing" : ": no such file") +
         "; give --" + what;
}

Actor load_actor_named(const std::string& name, double height_mm) {
  if (!is_builtin_actor(name)) return load_actor(name, height_mm);
  return load_actor_bytes(named_actor_glb(name, height_mm), name);
}

CaptureFolder open_capture(const fs::path& folder, const std::string& actor, const std::string& camera,
                           const fs::path& masks) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) throw IoError(folder.string() + ": is not a folder");
  if (!is_there(folder / "joints.csv")) throw IoError(folder.string() + ": is no capture folder (no joints.csv)");
  const fs::path report_path = folder / "report.json";
  const bool has_report = is_there(report_path);  // other programs write none, nor does a run that is killed
  const nlohmann::json report =
      has_report ? nlohmann::json::parse(read_file(report_path), nullptr, false) : nlohmann::json::object();
  if (!report.is_object()) throw IoError(report_path.string() + ": is not a JSON object");
  const nlohmann::json options = report.value("options", nlohmann::json());

  std::string actor_name = actor.empty() ? field<std::string>(options, "actor", "") : actor;
  const fs::path own_actor = folder / "actor.glb";
  if (actor.empty() && !is_builtin_actor(actor_name) &&
      fs::exists(own_actor, ignored))  // the file named may have changed
    actor_name = own_actor.string();
  if (actor_name.empty()) throw IoError(not_named(report_path, "actor"));
  if (actor.empty() && !is_builtin_actor(actor_name)) require_no_pipe(actor_name);
  CaptureFolder capture;
  capture.path = folder;
  capture.actor = load_actor_named(actor_name, field<double>(options, "height_mm", 0));
  capture.camera = load_camera_of(report_path, camera, options, masks);
  capture.joints = read_joints_csv(folder / "joints.csv");
  capture.rows = read_rows(folder, capture.joints);
  capture.fps = frames_per_second(capture.rows);
  capture.video = field<std::string>(options, "video", "");
  capture.first = field<int64_t>(options, "first", 0);
  capture.frames = field<int64_t>(options, "frames", -1);
  capture.run = describe(options);
  capture.speed = speed_of(report, capture.rows);
  if (report.contains("floor") && !report["floor"].is_null())
    capture.floor = floor_from_json(report["floor"], report_path.string());
  if (camera.empty() && !field<std::string>(options, "floor", "").empty()) capture.camera.floor = capture.floor;
  if (fs::exists(folder / "angles.csv", ignored)) capture.angles = read_angles_csv(folder / "angles.csv");
  if (const fs::path file = folder / "vertices.pc2"; fs::exists(file, ignored)) {
    capture.vertices.emplace(file);
    require_points(*capture.vertices, file, actor_name, capture.actor.n_vertices());
  }
  return capture;
}

std::string own_camera_file(const fs::path& folder) {
  std::error_code ignored;
  const fs::path own = folder / "camera.json";
  return fs::exists(own, ignored) ? own.string() : std::string();
}

std::vector<InputFile> capture_inputs(const std::string& option, const fs::path& folder) {
  std::vector<InputFile> inputs;
  if (folder.empty()) return inputs;
  for (const char* name : {"report.json", "actor.glb", "camera.json", "vertices.pc2", "frames.csv", "joints.csv",
                           "angles.csv", "detections.jsonl", "capture.glb", "motion.bvh", "overlay.mp4"})
    inputs.push_back({option, folder / name});
  std::error_code ignored;
  const fs::path report_path = folder / "report.json";
  if (!fs::is_regular_file(report_path, ignored)) return inputs;
  const nlohmann::json report = nlohmann::json::parse(read_file(report_path), nullptr, false);
  if (!report.is_object()) return inputs;
  for (const char* name : {"video", "camera", "floor", "actor", "background", "detections"})
    inputs.push_back({option, field<std::string>(report.value("options", nlohmann::json()), name, "")});
  return inputs;
}

void require_rows(const CaptureFolder& capture, const std::vector<int64_t>& rows, const char* file, size_t n,
                  const char* entries) {
  for (int64_t row : rows) {
    if (capture.rows[row].tracked() && row >= static_cast<int64_t>(n))
      throw IoError((capture.path / file).string() +
                    format(": has %zu %s, frames.csv %zu rows: they are of different runs or one is cut off", n,
                           entries, capture.rows.size()));
  }
}

std::vector<float> to_camera_mm(std::vector<float> positions) {
  for (size_t i = 0; i + 2 < positions.size(); i += 3) {
    positions[i] *= 1000;
    positions[i + 1] *= -1000;
    positions[i + 2] *= -1000;
  }
  return positions;
}

std::vector<float> known_sample(std::optional<Pc2Reader>& vertices, int64_t index) {
  if (!vertices || index >= vertices->n_samples()) return {};
  std::vector<float> positions(3 * static_cast<size_t>(vertices->n_points()));
  vertices->read(static_cast<int>(index), positions);
  const bool known = std::all_of(positions.begin(), positions.end(), [](float value) { return std::isfinite(value); });
  return known ? to_camera_mm(std::move(positions)) : std::vector<float>();
}

std::vector<float> captured_vertices(CaptureFolder& capture, int64_t row) {
  return known_sample(capture.vertices, row);
}

std::vector<float> captured_joints(const CaptureFolder& capture, int64_t row) {
  if (row >= static_cast<int64_t>(capture.joints.frames.size())) return {};
  return to_camera_mm(capture.joints.frames[row]);
}

}  // namespace livecap
