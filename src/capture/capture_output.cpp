#include "capture/capture_output.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/log.h"
#include "base/require_apart.h"
#include "base/require_writable.h"
#include "base/text.h"
#include "capture/report_json.h"
#include "export/export_frame.h"
#include "export/frame_times.h"
#include "image/empty_picture.h"
#include "livecap/error.h"
#include "picture/overlay.h"

namespace livecap {
namespace {

// What a run makes at its end; a folder from an earlier run must not look finished while this one is going on.
constexpr const char* kFinalFiles[] = {"capture.glb", "report.json", "overlay.mp4"};
constexpr const char* kGrowingFiles[] = {"actor.glb",  "camera.json", "vertices.pc2", "motion.bvh",
                                         "frames.csv", "joints.csv",  "angles.csv",   "detections.jsonl"};

// Of a picture, beside the person; shadows and somebody else make less.
constexpr double kOtherScene = 0.12;

std::vector<std::string> stage_names() {
  std::vector<std::string> names;
  for (int i = 0; i < kStageCount; ++i) names.emplace_back(stage_name(static_cast<CaptureStage>(i)));
  return names;
}

}  // namespace

void CaptureOutput::make_folder(const CaptureOptions& options) {
  const std::filesystem::path folder = options.out;
  std::vector<std::filesystem::path> results;
  for (const char* name : kFinalFiles) results.push_back(folder / name);
  for (const char* name : kGrowingFiles) results.push_back(folder / name);
  if (!options.trace.empty()) results.emplace_back(options.trace);
  require_apart({{"--video", options.video},
                 {"--camera", options.camera},
                 {"--floor", options.floor},
                 {"--actor", options.actor},
                 {"--background", options.background},
                 {"--detections", options.detections}},
                results);
  if (!options.trace.empty()) require_writable(options.trace);
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code || !std::filesystem::is_directory(folder))
    throw IoError(options.out + ": cannot be made a folder" + (code ? ": " + code.message() : ""));
  if (::access(folder.c_str(), W_OK) != 0)
    throw IoError(options.out + ": cannot be written to: " + std::strerror(errno));
}

CaptureOutput::CaptureOutput(const CaptureOptions& options, const Actor& actor, const std::string& actor_glb,
                             const Camera& camera, double fps)
    : options_(options), actor_(actor), camera_(camera), fps_(fps > 0 ? fps : 30), folder_(options.out) {
  std::error_code code;
  for (const char* name : kFinalFiles) std::filesystem::remove(in_folder(name), code);

  write_file_atomically(in_folder("actor.glb"), actor_glb);
  save_camera(camera, in_folder("camera.json"));
  pc2_.emplace(in_folder("vertices.pc2"), actor.n_vertices());
  bvh_.emplace(in_folder("motion.bvh"), actor, fps_, options.bvh_unit_m);
  frames_csv_.emplace(in_folder("frames.csv"), stage_names());
  joints_csv_.emplace(in_folder("joints.csv"), actor);
  angles_csv_.emplace(in_folder("angles.csv"), actor.skeleton);
  detections_.emplace(in_folder("detections.jsonl"));
  if (options.overlay) overlay_.emplace(in_folder("overlay.mp4").string(), camera.width, camera.height, fps_);

  // Before the first result: the template as it is bound, at the origin.
  held_vertices_m_.resize(actor.mesh.positions.size());
  std::transform(actor.mesh.positions.begin(), actor.mesh.positions.end(), held_vertices_m_.begin(),
                 [](float mm) { return static_cast<float>(kMetresPerMm * mm); });
}

void CaptureOutput::write_result(const FrameReport& report, const TrackResult& result, const Detections& detections) {
  const bool tracked = is_tracked(report.status);
  if (tracked) {
    held_vertices_m_ = gltf_from_camera(result.vertices_mm);
    held_pose_ = result.pose;
    bvh_->append(result.pose);
  } else {
    bvh_->append_held();
  }
  pc2_->append(held_vertices_m_);
  if (held_pose_) {
    joints_csv_->append(report.index, report.pts_ms, tracked, *held_pose_);
    angles_csv_->append(report.index, report.pts_ms, tracked, *held_pose_);
  } else {
    joints_csv_->append_missing(report.index, report.pts_ms);
    angles_csv_->append_missing(report.index, report.pts_ms);
  }
  detections_->append(detections);
  CapturedFrame frame;
  frame.tracked = tracked;
  if (tracked) frame.pose = result.pose;
  poses_.push_back(std::move(frame));
}

void CaptureOutput::write_row(const FrameReport& report) {
  frames_csv_->append(report, track_status_name(report.status));
  reports_.push_back(report);
}

FrameReport CaptureOutput::publish(WorkItem& item) {
  n_in_empty_ += item.detections.person && item.report.index < options_.background_frames;
  if (is_tracked(item.report.status) && item.gate.has_network)  // which tells what the person is
    changed_.push_back(item.gate.change.changed);
  for (FrameReport& dropped : item.dropped_before) {
    Detections nobody;
    nobody.frame_index = dropped.index;
    write_result(dropped, {}, nobody);
    write_row(dropped);
    if (overlay_) overlay_->skip(1);
  }
  Timer timer;
  if (overlay_) {
    const bool tracked = is_tracked(item.report.status);
    overlay_->write(tracked ? render_overlay(actor_, item.result.vertices_mm, camera_, item.image) : item.image);
  }
  item.detections.frame_index = item.report.index;
  write_result(item.report, item.result, item.detections);
  item.report.stage_ms[static_cast<int>(CaptureStage::kOutput)] = timer.elapsed_ms();
  item.report.latency_ms = item.since_read.elapsed_ms();
  write_row(item.report);

  if (!since_first_) {
    since_first_.emplace();
  } else {
    ++n_after_first_;
    first_to_last_ms_ = since_first_->elapsed_ms();
  }
  return item.report;
}

CaptureReport CaptureOutput::finish(const ocl::DevicePair& devices, const std::string& model_sha256,
                                    const RunEnd& end) {
  CaptureReport report;
  report.complete = !end.broken_off;
  report.input_complete = end.input_complete;
  report.learned_frames = end.learned_frames;
  report.device_allocations = end.device_allocations;
  report.warnings = end.warnings;
  report.floor = end.floor;
  if (end.broken_off) report.warnings.push_back(options_.video + ": stopped before its end");
  report.frames = static_cast<int64_t>(reports_.size());
  std::array<std::vector<double>, kStageCount> stage_ms;
  std::vector<double> latency;
  double iou_sum = 0;
  for (const FrameReport& frame : reports_) {
    report.dropped += frame.status == TrackStatus::kDropped;
    report.damaged += frame.status == TrackStatus::kDamaged;
    if (!is_tracked(frame.status)) continue;
    ++report.tracked;
    iou_sum += frame.iou;
    latency.push_back(frame.latency_ms);
    for (int i = 0; i < kStageCount; ++i) stage_ms[i].push_back(frame.stage_ms[i]);
  }
  if (report.tracked > 0) report.mean_iou = iou_sum / static_cast<double>(report.tracked);
  for (int i = 0; i < kStageCount; ++i) report.stage_median_ms[i] = median(stage_ms[i]);
  report.latency_ms = median(latency);
  if (first_to_last_ms_ > 0) report.fps = 1000.0 * static_cast<double>(n_after_first_) / first_to_last_ms_;
  if (n_in_empty_ > 0)
    report.warnings.push_back(not_empty_warning(options_.video, n_in_empty_, options_.background_frames));
  if (const double changed = median(changed_); changed > kOtherScene)
    report.warnings.push_back(
        (options_.background.empty()
             ? options_.video + format(": its first %d frames differ", options_.background_frames)
             : options_.background + ": differs") +
        format(
            " from the video in %.0f %% of what is beside the person: not the empty scene as this camera sees it, or "
            "in another light; the masks are worse for it",
            100 * changed));
  if (report.tracked == 0) report.warnings.push_back(options_.video + ": nobody was tracked in any frame");

  if (overlay_) {
    overlay_->close();
    report.overlay = in_folder("overlay.mp4").string();
  }
  std::vector<double> pts_ms;
  for (const FrameReport& frame : reports_) pts_ms.push_back(frame.pts_ms);
  const std::vector<double> times_s = uneven_times_s(pts_ms, fps_);
  if (!times_s.empty())
    report.warnings.push_back(
        uneven_warning(options_.video, fps_, "capture.glb", overlay_ ? "motion.bvh and overlay.mp4" : "motion.bvh"));
  pc2_.reset();
  report.pc2 = in_folder("vertices.pc2").string();
  report.bvh = in_folder("motion.bvh").string();
  CaptureGlbReport glb;
  if (report.tracked > 0) {
    CaptureGlbOptions glb_options;
    glb_options.fps = fps_;
    glb_options.times_s = times_s;
    glb_options.camera = camera_;
    glb = write_capture_glb(in_folder("capture.glb"), actor_, poses_, in_folder("vertices.pc2"), glb_options);
    report.glb = in_folder("capture.glb").string();
  }
  report.report = in_folder("report.json").string();
  write_file_atomically(report.report, report_json(options_, report, devices, model_sha256, glb, actor_));
  return report;
}

}  // namespace livecap
