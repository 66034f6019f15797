// Performance capture of a whole video: what `livecap capture` does, as a library call.
//
//   livecap::CaptureOptions options;
//   options.video = "dance.mp4";
//   options.camera = "camera.json";
//   options.actor = "actor.glb";
//   options.out = "capture";
//   livecap::CaptureReport report = livecap::run_capture(options);
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "livecap/camera.h"
#include "livecap/method.h"

namespace livecap {

// What happened in one input frame. Every input frame gets exactly one.
enum class TrackStatus {
  kOk,           // tracked; at most a few frames on end by the silhouette alone when the network misses the person
  kInitialized,  // tracked, after an initialisation (first frame of a person, or recovery after loss)
  kNobody,       // the network sees nobody; the last result is held
  kLost,         // somebody is there but the pose could not be solved; the last result is held
  kDamaged,      // the video frame could not be decoded; the last result is held
  kDropped,      // live pacing only: a newer frame was there first; the last result is held
};

// "ok", "initialized", "nobody", "lost", "damaged", "dropped".
const char* track_status_name(TrackStatus status);

// True for the two states in which the frame has a result of its own.
inline bool is_tracked(TrackStatus status) {
  return status == TrackStatus::kOk || status == TrackStatus::kInitialized;
}

struct CaptureOptions : MethodOptions {
  std::string video;             // video file, folder of images, or "webcam:N"
  std::string camera;            // camera.json; or
  double fov_deg = 0;            // field of view of the longer side, degrees
  std::string floor;             // camera.json or report.json whose floor counts; empty: the camera's, or a learned one
  std::string background;        // picture of the empty scene; or
  int background_frames = 0;     // the first N frames of the video are empty; or neither: the network's mask alone
  std::string detections;        // detections.jsonl to use instead of the network
  std::string out;               // folder to write (created)
  bool overlay = false;          // write overlay.mp4
  std::string trace;             // timeline of threads and devices to write, for chrome://tracing; empty: none
  bool sequential = false;       // one thread; the result is the same
  bool realtime = false;         // read the file at its own pace and drop what comes too early
  bool decoded = false;          // decode all frames before the first is processed: 3 bytes a pixel and frame
  bool smooth = false;           // filter the result with [0.15, 0.7, 0.15] over time once more
  double missed_detections = 0;  // share of frames, chosen at random, in which the network is shown nothing: a test
  int draw = 0;                  // 0..99: moves the network's first crop aside by as many hundredths of a px: a test
  int64_t first = 0;             // first input frame to process
  int64_t frames = -1;           // at most this many; -1: all
  // So many of those are looked at before the first is captured, to learn where the floor is, how the person is lit and
  // what the network sees of bent legs: a capture that learns it on the way has its feet too near or too far in the
  // first seconds. 0: none, as of a webcam or a pipe, or with `realtime`.
  int64_t learn_frames = 90;
  double bvh_unit_m = 0.01;  // length of one BVH unit in metres

  // Throws ConfigError naming the option.
  void validate() const;
};

// Wall-clock per stage, ms. kRead .. kOutput run on different threads when pipelined.
enum class CaptureStage { kRead, kNetwork, kSegment, kPose, kSurface, kOutput, kCount };
inline constexpr int kStageCount = static_cast<int>(CaptureStage::kCount);
const char* stage_name(CaptureStage stage);

struct FrameReport {
  int64_t index = 0;  // of the input
  double pts_ms = 0;  // since the video's first frame
  TrackStatus status = TrackStatus::kNobody;
  double score = 0;              // network's person probability, 0..1
  double iou = 0;                // rendered mesh against the segmented silhouette, 0..1
  double pose_energy = 0;        // weighted, without unit; of the pose as it was solved, as is keypoint_error_px
  double surface_energy = 0;     // likewise, of the published result
  double keypoint_error_px = 0;  // mean over the detected keypoints
  std::array<double, kStageCount> stage_ms{};
  double latency_ms = 0;  // from having been read to having been published
};

struct CaptureReport {
  bool complete = true;        // false: stopped early by the progress callback, but for a webcam
  bool input_complete = true;  // false: the video ended before the length it promises, or had damaged frames
  int64_t learned_frames = 0;  // that were looked at beforehand
  int64_t frames = 0;          // rows in frames.csv
  int64_t tracked = 0;
  int64_t dropped = 0;
  int64_t damaged = 0;
  double fps = 0;         // frames per second of wall-clock after the first result
  double latency_ms = 0;  // median
  double mean_iou = 0;    // over tracked frames
  std::array<double, kStageCount> stage_median_ms{};
  int64_t device_allocations = 0;  // device buffers made between the first frame and the last: none
  std::vector<std::string> warnings;
  std::optional<FloorPlane> floor;             // that the person stood on at the end: as given, or as learned
  std::string glb, pc2, bvh, overlay, report;  // paths; empty when not written
};

// Called after each published frame by the thread that called run_capture; return false to stop early (what was written
// stays valid). n_frames: expected number of frames, 0 when unknown.
using CaptureProgress = std::function<bool(const FrameReport&, int64_t n_frames)>;

// Called after each frame that is looked at beforehand (CaptureOptions::learn_frames) by the same thread, n_seen counts
// from 1; return false to begin with what was learned so far: of frames that are under way by then, too.
using LearnProgress = std::function<bool(int64_t n_seen, int64_t n_frames)>;

// No file in `out` is touched before all inputs have been opened and the first frames looked at. While it runs OpenCV
// uses one thread in this process (cv::setNumThreads). Throws ConfigError, IoError (bad options, inputs or output
// folder), OclError (no device, a failed call), Error when the system allows no further thread, and whatever `progress`
// or `learning` throws.
CaptureReport run_capture(const CaptureOptions& options, const CaptureProgress& progress = {},
                          const LearnProgress& learning = {});

}  // namespace livecap
