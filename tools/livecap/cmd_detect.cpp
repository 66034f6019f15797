// livecap detect: the network alone. Writes detections.jsonl, which `livecap capture --detections` accepts, and the
// keypoints over the picture.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "base/timer.h"
#include "command.h"
#include "detect/detections_io.h"
#include "detect/find_model.h"
#include "detect/pose_detector.h"
#include "image/undistort.h"
#include "image/video.h"
#include "image/video_camera.h"
#include "livecap/camera.h"
#include "livecap/error.h"
#include "method_options.h"
#include "ocl/context.h"
#include "progress.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

namespace fs = std::filesystem;

struct DetectCommand {
  std::string video;
  std::string camera;
  double fov_deg = 0;
  std::string out;
  std::string model = "full";
  std::string device;
  int64_t first = 0;
  int64_t frames = -1;
  bool no_overlay = false;
};

constexpr std::pair<Keypoint, Keypoint> kLimbs[] = {
    {kNeck, kLeftShoulder},
    {kNeck, kRightShoulder},
    {kLeftShoulder, kLeftElbow},
    {kRightShoulder, kRightElbow},
    {kLeftElbow, kLeftWrist},
    {kRightElbow, kRightWrist},
    {kLeftWrist, kLeftHand},
    {kRightWrist, kRightHand},
    {kNeck, kPelvis},
    {kPelvis, kLeftHip},
    {kPelvis, kRightHip},
    {kLeftHip, kLeftKnee},
    {kRightHip, kRightKnee},
    {kLeftKnee, kLeftAnkle},
    {kRightKnee, kRightAnkle},
    {kLeftAnkle, kLeftToe},
    {kRightAnkle, kRightToe},
    {kNeck, kNose},
    {kNose, kLeftEye},
    {kNose, kRightEye},
};

// Left limbs orange, right blue, the middle white; what the network is unsure of is dark.
cv::Scalar color_of(Keypoint keypoint, float confidence) {
  const bool left = kKeypointNames[keypoint].substr(0, 5) == "left_";
  const bool right = kKeypointNames[keypoint].substr(0, 6) == "right_";
  const cv::Scalar color = left    ? cv::Scalar(255, 150, 30)
                           : right ? cv::Scalar(60, 150, 255)
                                   : cv::Scalar(255, 255, 255);
  return color * (0.25 + 0.75 * confidence);
}

void draw(const Detections& detections, ImageRgb& image) {
  if (!detections.person) return;
  cv::Mat canvas(image.height, image.width, CV_8UC3, image.pixels.data());
  const int thickness = std::max(1, image.height / 400);
  const auto point = [&](Keypoint k) {
    return cv::Point(cvRound(detections.keypoints[k].x_px), cvRound(detections.keypoints[k].y_px));
  };
  const auto confidence = [&](Keypoint k) { return detections.keypoints[k].confidence; };
  for (const auto& [a, b] : kLimbs) {
    if (confidence(a) <= 0 || confidence(b) <= 0) continue;
    cv::line(canvas, point(a), point(b), color_of(b, std::min(confidence(a), confidence(b))), thickness, cv::LINE_AA);
  }
  for (int i = 0; i < kKeypointCount; ++i) {
    const Keypoint k = static_cast<Keypoint>(i);
    if (confidence(k) > 0) cv::circle(canvas, point(k), 2 * thickness, color_of(k, confidence(k)), -1, cv::LINE_AA);
  }
}

void make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw IoError(folder.string() + ": cannot be made: " + code.message());
}

int run(const DetectCommand& options) {
  if (options.camera.empty() == (options.fov_deg == 0)) throw ConfigError("give either --camera FILE or --fov DEGREES");
  VideoReader video(options.video);
  const VideoInfo info = video.info();
  const Undistorter undistorter(video_camera(options.camera, options.fov_deg, info, options.video));
  const Camera camera = undistorter.undistorted_camera();

  detect::PoseDetectorOptions detector_options;
  detector_options.model = options.model;
  detector_options.mask = false;
  detect::find_model(options.model);  // complain before the device is set up
  ocl::DeviceContext device(ocl::select_device(options.device));
  detect::PoseDetector detector(device, detector_options);

  video.start_at(options.first);
  const fs::path out = options.out;
  make_folder(out);
  detect::DetectionsWriter writer(out / "detections.jsonl");
  std::unique_ptr<VideoWriter> overlay;
  if (!options.no_overlay) {
    overlay = std::make_unique<VideoWriter>((out / "overlay.mp4").string(), info.width, info.height,
                                            info.fps > 0 ? info.fps : 30);
  }

  catch_interrupt();
  Progress progress("detect");
  const int64_t hint = info.frame_count_hint < 0 ? 0 : std::max<int64_t>(0, info.frame_count_hint - options.first);
  const int64_t total = options.frames < 0 ? hint : hint == 0 ? options.frames : std::min(hint, options.frames);
  int64_t done = 0;
  int64_t found = 0;
  std::vector<double> network_ms;
  for (Frame frame; !interrupted() && (options.frames < 0 || done < options.frames) && video.read(frame);) {
    ImageRgb image = undistorter.undistort(frame.image);
    const Timer timer;
    const Detections detections = detector.detect(image, camera, frame.index, frame.pts_ms / 1000);
    network_ms.push_back(timer.elapsed_ms());
    writer.append(detections);
    if (overlay) {
      draw(detections, image);
      overlay->write(image);
    }
    found += detections.person;
    progress.update(++done, total, format("score %.2f", detections.score));
  }
  progress.finish();
  if (overlay) overlay->close();

  std::printf("frames  %lld, with a person %lld, damaged %lld\n", static_cast<long long>(done),
              static_cast<long long>(found), static_cast<long long>(video.damaged_frames()));
  std::printf("network %.1f ms a frame (median) on %s\n", median(network_ms), device.info().label().c_str());
  std::printf("wrote   %s\n", (out / "detections.jsonl").c_str());
  if (overlay) std::printf("wrote   %s\n", (out / "overlay.mp4").c_str());
  if (interrupted()) throw Error(format("interrupted after %lld frames", static_cast<long long>(done)));
  return kExitOk;
}

}  // namespace

void add_detect_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<DetectCommand>();
  CLI::App* command = app.add_subcommand("detect", "run the pose network alone over a video");
  command->add_option("--video", options->video, "video file, folder of images, or webcam:N")->required();
  add_camera_options(*command, options->camera, options->fov_deg);
  command->add_option("--out", options->out, "folder to write")->required()->check(not_empty());
  add_model_option(*command, options->model);
  add_network_device_option(*command, options->device);
  add_frame_options(*command, options->first, options->frames);
  command->add_flag("--no-overlay", options->no_overlay, "do not write overlay.mp4");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
