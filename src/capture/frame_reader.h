// Thread 1 of the pipeline: the input frames in order, undistorted, within the asked range.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/work_item.h"
#include "image/pace.h"
#include "image/undistort.h"
#include "image/video.h"
#include "livecap/camera.h"
#include "livecap/capture.h"

namespace livecap {

class FrameReader {
 public:
  // Opens the video and the camera. Throws IoError when their sizes differ, ConfigError for a size that no capture
  // takes.
  explicit FrameReader(const CaptureOptions& options);

  // The pinhole camera that the undistorted frames obey.
  const Camera& camera() const { return undistorted_camera_; }
  const VideoInfo& info() const { return info_; }
  // Frames that will come, 0 when unknown.
  int64_t n_frames() const;

  // Before the first read(). Gives `take` the pictures of the empty scene, undistorted: the background file, the first
  // frames of the video, or none. Then goes to the first frame asked for, and with CaptureOptions::decoded reads all of
  // them. Throws IoError, and ConfigError when the video ends before the first.
  void start(const std::function<void(const ImageRgb&)>& take);

  // Fills index, time, image; a damaged frame has status kDamaged. False at the end. With live pacing it waits until
  // the frame's time has come.
  bool read(WorkItem& item);

  // False when the input ended before the length it promises or frames of it could not be decoded. Known at the end.
  bool input_complete() const;

  // What the user should know about the input, after the last frame.
  std::vector<std::string> warnings() const;

 private:
  void read_empty_plates(const std::function<void(const ImageRgb&)>& take);
  // The next of those asked for. False at the end.
  bool next(Frame& frame);

  CaptureOptions options_;
  std::unique_ptr<VideoReader> video_;
  VideoInfo info_;
  Camera camera_;
  Camera undistorted_camera_;
  std::optional<Undistorter> undistorter_;
  int64_t taken_ = 0;
  std::deque<Frame> decoded_;  // that read() has not delivered yet
  Pace pace_;
};

}  // namespace livecap
