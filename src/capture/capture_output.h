// The capture folder (docs/formats.md): every writer is valid after each frame; capture.glb and report.json come
// last and exist only for a run that reached its end.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "capture/work_item.h"
#include "detect/detections_io.h"
#include "export/bvh.h"
#include "export/capture_glb.h"
#include "export/csv.h"
#include "export/pc2.h"
#include "image/video.h"
#include "livecap/camera.h"
#include "livecap/capture.h"
#include "ocl/device.h"

namespace livecap {

// How the run ended.
struct RunEnd {
  bool broken_off = false;     // by the caller, before the end of the video
  bool input_complete = true;  // see CaptureReport
  int64_t learned_frames = 0;
  int64_t device_allocations = 0;
  std::vector<std::string> warnings;
  std::optional<FloorPlane> floor = {};
};

class CaptureOutput {
 public:
  // Creates the folder. Throws ConfigError when an input lies where a result would; IoError when it is no folder or
  // cannot be written to. Loses nothing.
  static void make_folder(const CaptureOptions& options);

  // Creates all files that grow frame by frame, and removes what an earlier run left of the rest; so all else that may
  // fail comes before. actor_glb: the bytes kept as actor.glb beside the results. Throws IoError when something cannot
  // be written.
  CaptureOutput(const CaptureOptions& options, const Actor& actor, const std::string& actor_glb, const Camera& camera,
                double fps);

  // Writes one frame, and before it those that live pacing dropped. Returns the finished report of the frame.
  FrameReport publish(WorkItem& item);

  // Writes capture.glb and report.json, closes the overlay. model_sha256: empty when no network ran.
  CaptureReport finish(const ocl::DevicePair& devices, const std::string& model_sha256, const RunEnd& end);

 private:
  void write_result(const FrameReport& report, const TrackResult& result, const Detections& detections);
  void write_row(const FrameReport& report);  // the last file of a frame, since it holds the time the others took
  std::filesystem::path in_folder(const char* name) const { return folder_ / name; }

  CaptureOptions options_;
  const Actor& actor_;
  Camera camera_;
  double fps_;
  std::filesystem::path folder_;

  std::optional<Pc2Writer> pc2_;
  std::optional<BvhWriter> bvh_;
  std::optional<FramesCsvWriter> frames_csv_;
  std::optional<JointsCsvWriter> joints_csv_;
  std::optional<AnglesCsvWriter> angles_csv_;
  std::optional<detect::DetectionsWriter> detections_;
  std::optional<VideoWriter> overlay_;

  std::vector<float> held_vertices_m_;  // last result, or the template at rest, glTF frame
  std::optional<Pose> held_pose_;
  std::vector<CapturedFrame> poses_;
  std::vector<FrameReport> reports_;
  int n_in_empty_ = 0;  // frames called empty in which the network sees a person
  // Of each tracked frame: the share of what is beside the person that differs from the background.
  std::vector<double> changed_;
  std::optional<Timer> since_first_;
  double first_to_last_ms_ = 0;
  int64_t n_after_first_ = 0;
};

}  // namespace livecap
