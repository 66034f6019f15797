#include "capture/report_json.h"

#include <sys/resource.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/floor_plane.h"
#include "base/json_text.h"
#include "image/video.h"
#include "ocl/buffer.h"
#include "synth/named_actor.h"

namespace livecap {
namespace {

using Json = nlohmann::ordered_json;

Json device_json(const ocl::DeviceInfo& device) {
  return {{"device", device.device_name},
          {"platform", device.platform_name},
          {"platform_version", device.platform_version},
          {"driver_version", device.driver_version},
          {"compute_units", device.compute_units}};
}

// Paths are absolute, so that the report can be read from anywhere.
Json path_json(const std::string& path) {
  if (path.empty()) return nullptr;
  std::error_code code;
  const auto absolute = std::filesystem::absolute(path, code);
  return code ? path : absolute.lexically_normal().string();
}

constexpr double kMib = 1024 * 1024;

// Of the whole process, device memory of CPU devices included.
double peak_resident_mib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / kMib;
}

}  // namespace

std::string report_json(const CaptureOptions& options, const CaptureReport& report, const ocl::DevicePair& devices,
                        const std::string& model_sha256, const CaptureGlbReport& glb, const Actor& actor) {
  Json json;
  json["program"] = "livecap " LIVECAP_VERSION;
  json["complete"] = report.complete;
  json["input_complete"] = report.input_complete;
  json["learned_frames"] = report.learned_frames;
  json["frames"] = report.frames;
  json["tracked"] = report.tracked;
  json["dropped"] = report.dropped;
  json["damaged"] = report.damaged;
  json["fps"] = report.fps;
  json["latency_ms"] = report.latency_ms;
  json["mean_silhouette_iou"] = report.mean_iou;
  for (int i = 0; i < kStageCount; ++i)
    json["stage_median_ms"][stage_name(static_cast<CaptureStage>(i))] = report.stage_median_ms[i];
  json["memory_mib"] = {{"peak_resident", peak_resident_mib()},
                        {"peak_device_buffers", static_cast<double>(ocl::BufferMemory::peak) / kMib}};
  json["device_allocations_while_running"] = report.device_allocations;
  json["warnings"] = report.warnings;
  json["floor"] = report.floor ? Json(floor_json(*report.floor)) : Json(nullptr);

  Json& o = json["options"];
  o["video"] = is_webcam(options.video) ? Json(options.video) : path_json(options.video);
  o["camera"] = path_json(options.camera);
  o["fov_deg"] = options.fov_deg;
  o["floor"] = path_json(options.floor);
  o["background"] = path_json(options.background);
  o["background_frames"] = options.background_frames;
  o["actor"] = is_builtin_actor(options.actor) ? Json(options.actor) : path_json(options.actor);
  o["height_mm"] = options.height_mm;
  o["model"] = options.model;
  o["detections"] = path_json(options.detections);
  o["missed_detections"] = options.missed_detections;
  o["draw"] = options.draw;
  o["surface"] = options.surface;
  o["sequential"] = options.sequential;
  o["pace"] = options.realtime ? "realtime" : "every frame";
  o["decoded"] = options.decoded;
  o["smooth"] = options.smooth;
  o["without"] = options.without;
  o["rigidity"] = options.rigidity;
  o["first"] = options.first;
  o["frames"] = options.frames;
  o["learn_frames"] = options.learn_frames;

  json["actor"] = {{"name", actor.name},
                   {"vertices", actor.n_vertices()},
                   {"triangles", actor.mesh.n_triangles()},
                   {"joint_angles", actor.skeleton.n_dofs()},
                   {"notes", actor.notes}};
  json["network"] = model_sha256.empty() ? Json(nullptr) : Json{{"model", options.model}, {"sha256", model_sha256}};
  json["devices"] = {{"network", device_json(devices.cnn)}, {"solver", device_json(devices.solver)}};
  json["capture_glb"] = {{"keys", glb.n_keys},
                         {"morph_targets", glb.n_morph_targets},
                         {"mean_error_mm", glb.mean_error_mm},
                         {"max_error_mm", glb.max_error_mm},
                         {"bytes", glb.bytes}};
  return json_text(json, 2) + "\n";
}

}  // namespace livecap
