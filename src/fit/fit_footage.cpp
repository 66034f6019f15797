// read_footage of fit_actor.h.
#include <algorithm>
#include <memory>

#include "base/text.h"
#include "detect/pose_detector.h"
#include "fit/fit_actor.h"
#include "image/empty_picture.h"
#include "image/foreground.h"
#include "image/undistort.h"
#include "image/video.h"
#include "image/video_camera.h"
#include "livecap/error.h"

namespace livecap {

namespace {

constexpr int kLeastFrames = 4;
constexpr double kLeastConfidence = 0.5;

// All joints of trunk and legs are seen, inside the picture.
bool is_whole(const Detections& detections, const Camera& camera) {
  if (!detections.person) return false;
  for (int k : {kLeftShoulder, kRightShoulder, kLeftHip, kRightHip, kLeftKnee, kRightKnee, kLeftAnkle, kRightAnkle}) {
    const KeypointDetection& point = detections.keypoints[k];
    if (point.confidence < kLeastConfidence || point.x_px < 0 || point.y_px < 0 || point.x_px >= camera.width ||
        point.y_px >= camera.height)
      return false;
  }
  return true;
}

// Share of the mask's pixels on the picture's border: more than a little and a part of the person is cut off.
bool is_cut_off(const ImageGray& mask, int area_px) {
  int on_border = 0;
  for (int x = 0; x < mask.width; ++x)
    on_border += (mask.pixels[x] > 127) + (mask.pixels[(size_t(mask.height) - 1) * mask.width + x] > 127);
  for (int y = 0; y < mask.height; ++y)
    on_border += (mask.pixels[size_t(y) * mask.width] > 127) + (mask.pixels[size_t(y + 1) * mask.width - 1] > 127);
  return on_border * on_border > 0.01 * area_px;
}

BackgroundModel train(const FitActorOptions& options, const Undistorter& undistorter) {
  BackgroundModel background;
  if (options.background.empty() && options.background_frames == 0) return background;
  VideoReader reader(options.video);
  read_empty_pictures(options.background, options.background_frames, options.video, reader,
                      [&](ImageRgb&& picture) { background.train(undistorter.undistort(std::move(picture))); });
  return background;
}

}  // namespace

FitFootage read_footage(ocl::DeviceContext& network_device, ocl::DeviceContext& device, const FitActorOptions& options,
                        const FitProgress& progress) {
  options.validate();
  VideoReader video(options.video);
  const VideoInfo info = video.info();
  const Undistorter undistorter(video_camera(options.camera, options.fov_deg, info, options.video));
  FitFootage footage;
  footage.camera = undistorter.undistorted_camera();
  ForegroundSegmenter foreground(device, train(options, undistorter), info.width, info.height);
  DeviceFrame device_frame(device, info.width, info.height);
  detect::PoseDetectorOptions detector_options;
  detector_options.model = options.model;
  detect::PoseDetector detector(network_device, detector_options);

  int n_person = 0, n_in_empty = 0, spacing = 1;
  const int total = info.frame_count_hint > 0
                        ? static_cast<int>(std::min<int64_t>(info.frame_count_hint, options.max_frames))
                        : options.max_frames;
  Frame frame;
  while (footage.n_looked_at < options.max_frames && video.read(frame)) {
    if (progress && !progress("frames", footage.n_looked_at, std::max(total, footage.n_looked_at)))
      throw Error("interrupted");
    ++footage.n_looked_at;
    if (frame.damaged) continue;
    ImageRgb image = undistorter.undistort(std::move(frame.image));
    Detections detections = detector.detect(image, footage.camera, frame.index, frame.pts_ms / 1000);
    n_person += detections.person;
    n_in_empty += detections.person && frame.index < options.background_frames;
    if (!is_whole(detections, footage.camera)) continue;
    if (footage.n_seen++ % spacing != 0) continue;
    FitFrame kept;
    kept.index = frame.index;
    foreground.segment(image, detections.mask, device_frame, kept.mask);
    kept.silhouette = make_silhouette(kept.mask);
    if (kept.silhouette.empty() || is_cut_off(kept.mask, kept.silhouette.area_px)) {
      --footage.n_seen;
      continue;
    }
    kept.image = std::move(image);
    detections.mask = {};
    kept.detections = detections;
    footage.frames.push_back(std::move(kept));
    // Twice as many as are wanted: every second goes, and from now on half as many come.
    if (static_cast<int>(footage.frames.size()) < 2 * options.n_frames) continue;
    for (size_t i = 0; 2 * i < footage.frames.size(); ++i)
      if (i > 0) footage.frames[i] = std::move(footage.frames[2 * i]);
    footage.frames.resize((footage.frames.size() + 1) / 2);
    spacing *= 2;
  }
  if (n_person == 0) throw ConfigError(options.video + ": the network sees nobody in its frames");
  if (static_cast<int>(footage.frames.size()) < kLeastFrames)
    throw ConfigError(options.video +
                      format(": %zu of %d frames show a whole person, from head to feet; at least %d are needed",
                             footage.frames.size(), footage.n_looked_at, kLeastFrames));
  if (n_in_empty > 0) footage.notes.push_back(not_empty_warning(options.video, n_in_empty, options.background_frames));
  return footage;
}

}  // namespace livecap
