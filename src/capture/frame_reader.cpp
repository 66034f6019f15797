#include "capture/frame_reader.h"

#include <chrono>
#include <thread>
#include <utility>

#include "base/text.h"
#include "image/empty_picture.h"
#include "image/picture_size.h"
#include "image/video_camera.h"
#include "livecap/error.h"

namespace livecap {

FrameReader::FrameReader(const CaptureOptions& options)
    : options_(options), video_(std::make_unique<VideoReader>(options.video)), info_(video_->info()) {
  require_picture_size(options.video, info_.width, info_.height);
  camera_ = video_camera(options.camera, options.fov_deg, info_, options.video, options.floor);
  undistorter_.emplace(camera_);
  undistorted_camera_ = undistorter_->undistorted_camera();
}

void FrameReader::start(const std::function<void(const ImageRgb&)>& take) {
  read_empty_plates(take);
  video_->start_at(options_.first);
  Frame frame;
  while (options_.decoded && next(frame)) decoded_.push_back(std::move(frame));
}

int64_t FrameReader::n_frames() const {
  if (info_.frame_count_hint < 0) return options_.frames > 0 ? options_.frames : 0;
  const int64_t left = std::max<int64_t>(0, info_.frame_count_hint - options_.first);
  return options_.frames > 0 ? std::min(left, options_.frames) : left;
}

void FrameReader::read_empty_plates(const std::function<void(const ImageRgb&)>& take) {
  // A reader of its own, so that the plate frames are also captured, of what has a second start.
  const bool own = options_.background_frames > 0 && can_be_read_again(options_.video);
  const std::unique_ptr<VideoReader> second = own ? std::make_unique<VideoReader>(options_.video) : nullptr;
  read_empty_pictures(options_.background, options_.background_frames, options_.video, own ? *second : *video_,
                      [&](ImageRgb&& plate) { take(undistorter_->undistort(std::move(plate))); });
}

bool FrameReader::next(Frame& frame) {
  if (options_.frames > 0 && taken_ >= options_.frames) return false;
  if (!video_->read(frame)) return false;
  ++taken_;
  return true;
}

bool FrameReader::read(WorkItem& item) {
  Timer timer;
  Frame frame;
  if (!options_.decoded) {
    if (!next(frame)) return false;
  } else if (!decoded_.empty()) {
    frame = std::move(decoded_.front());
    decoded_.pop_front();
  } else {
    return false;
  }
  item.report.index = frame.index;
  item.report.pts_ms = frame.pts_ms;
  if (frame.damaged) item.report.status = TrackStatus::kDamaged;
  item.image = undistorter_->undistort(std::move(frame.image));
  item.report.stage_ms[static_cast<int>(CaptureStage::kRead)] = timer.elapsed_ms();
  if (options_.realtime && !is_webcam(options_.video)) {  // a camera keeps its own pace
    const double early_ms = pace_.early_ms(frame.pts_ms);
    if (early_ms > 0) std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(early_ms));
  }
  item.since_read.restart();
  return true;
}

bool FrameReader::input_complete() const {
  return video_->damaged_frames() == 0 && !video_->truncated();
}

std::vector<std::string> FrameReader::warnings() const {
  std::vector<std::string> list;
  if (video_->damaged_frames() > 0)
    list.push_back(options_.video +
                   format(": %lld damaged frame(s)", static_cast<long long>(video_->damaged_frames())));
  if (video_->truncated())
    list.push_back(options_.video +
                   (is_webcam(options_.video) ? ": broke off" : ": ends before the length it promises"));
  return list;
}

}  // namespace livecap
