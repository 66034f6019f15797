// livecap live: a camera in, the skeleton out over the network while it happens; captured by include/livecap/live.h.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/log.h"
#include "base/text.h"
#include "base/timer.h"
#include "command.h"
#include "export/udp_sender.h"
#include "export/vmc.h"
#include "image/empty_picture.h"
#include "image/image_io.h"
#include "image/pace.h"
#include "image/video.h"
#include "image/video_camera.h"
#include "image/video_window.h"
#include "live_preview.h"
#include "livecap/error.h"
#include "livecap/live.h"
#include "method_options.h"
#include "progress.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

struct LiveCommand {
  LiveOptions live;
  std::string video;
  std::string camera;
  double fov_deg = 0;
  std::string floor;
  std::string background;
  int background_frames = 0;
  std::string vmc;
  bool show = false;
  int64_t frames = -1;
};

Picture picture_of(const ImageRgb& image, double time_s) {
  return {image.pixels.data(), image.width, image.height, 0, PixelFormat::kRgb, time_s};
}

// Pictures at the pace that they were taken at. A camera's are read as they come, but for those that waited in its
// driver while nobody read: they are old.
class Pictures {
 public:
  Pictures(VideoReader& video, bool is_camera) : video_(video), is_camera_(is_camera) {}

  // The next one that can be used; false at the end. Waits until its time has come.
  bool next(Frame& frame) {
    do {
      if (!video_.read(frame)) return false;
      if (is_camera_ && !begun_) skip_old(frame);
      ++(frame.damaged ? n_damaged : frame.pts_ms > last_pts_ms_ ? n_good : n_untimely);
    } while (frame.damaged || !(frame.pts_ms > last_pts_ms_));
    last_pts_ms_ = frame.pts_ms;
    while (!is_camera_ && !interrupted()) {
      const double early_ms = pace_.early_ms(frame.pts_ms);
      if (early_ms <= 0) break;
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(std::min(early_ms, 100.0)));
    }
    return true;
  }

  int64_t n_good = 0, n_damaged = 0;
  int64_t n_untimely = 0;  // whose time is not after that of the one before

 private:
  void skip_old(Frame& frame) {
    constexpr int kMostWaiting = 64;  // of any driver
    constexpr double kFreshMs = 5;    // what is read sooner has waited
    begun_ = true;
    for (int i = 0; i < kMostWaiting; ++i) {
      Timer timer;
      if (!video_.read(frame) || timer.elapsed_ms() > kFreshMs) break;
    }
  }

  VideoReader& video_;
  bool is_camera_;
  bool begun_ = false;
  double last_pts_ms_ = -std::numeric_limits<double>::infinity();
  Pace pace_;
};

// What was heard of all pictures.
struct Totals {
  int64_t pictures = 0, tracked = 0, dropped = 0, sent = 0;
  std::vector<double> latency_ms;

  void add(const FrameReport& report) {
    ++pictures;
    dropped += report.status == TrackStatus::kDropped;
    if (!is_tracked(report.status)) return;
    ++tracked;
    latency_ms.push_back(report.latency_ms);
  }
};

int run(const LiveCommand& options) {
  if (options.camera.empty() && options.fov_deg == 0) throw ConfigError("give either --camera FILE or --fov DEGREES");
  if (options.show) choose_window_driver();
  const ImageThreads one_thread(1);
  catch_interrupt();
  VideoReader video(options.video);
  LiveOptions live = options.live;
  live.camera = video_camera(options.camera, options.fov_deg, video.info(), options.video, options.floor);
  std::vector<ImageRgb> plates;
  read_empty_pictures(options.background, options.background_frames, options.video, video,
                      [&](ImageRgb&& plate) { plates.push_back(std::move(plate)); });
  for (const ImageRgb& plate : plates) live.background.push_back(picture_of(plate, 0));
  std::optional<UdpSender> receiver;
  if (!options.vmc.empty()) receiver.emplace(options.vmc);

  std::optional<VmcEncoder> encoder;  // once the actor is known
  std::optional<LivePreview> preview;
  Totals totals;
  Progress progress("live");
  LiveCapture capture(live, [&](const LiveResult& result) {
    totals.add(result.report);
    if (receiver && result.report.status != TrackStatus::kDropped)
      totals.sent += receiver->send(encoder->packet(result)) ? 1 : 0;
    if (preview) preview->show(result);
    progress.update(totals.pictures, 0,
                    format("%s, %.0f ms behind, %lld dropped", track_status_name(result.report.status),
                           result.report.latency_ms, static_cast<long long>(totals.dropped)));
    return !interrupted();
  });
  encoder.emplace(capture.actor(), live.camera.floor);
  if (options.show) preview.emplace(capture.actor(), live.camera, "LiveCap-CL: " + options.video);

  Pictures pictures(video, is_webcam(options.video));
  Frame frame;
  const auto goes_on = [&] {
    return (options.frames < 0 || pictures.n_good < options.frames) && !interrupted() &&
           !(preview && preview->closed());
  };
  for (int64_t index = 0; goes_on() && pictures.next(frame); ++index) {
    if (preview) preview->expect(index, frame.image);
    if (!capture.push(picture_of(frame.image, frame.pts_ms / 1000))) break;
  }
  capture.close();
  progress.finish();
  if (totals.pictures == 0 && interrupted()) throw Error("interrupted before the first picture");
  if (totals.pictures == 0) throw IoError(options.video + ": no picture was left to capture");
  std::printf("pictures    %lld, tracked %lld, dropped %lld\n", static_cast<long long>(totals.pictures),
              static_cast<long long>(totals.tracked), static_cast<long long>(totals.dropped));
  std::printf("latency     %.0f ms (median)\n", median(totals.latency_ms));
  if (pictures.n_damaged > 0)
    log_warning(options.video + format(": %lld damaged frame(s)", static_cast<long long>(pictures.n_damaged)));
  if (pictures.n_untimely > 0)
    log_warning(options.video + format(": %lld frame(s) whose time does not come after the one before were left out",
                                       static_cast<long long>(pictures.n_untimely)));
  if (video.truncated()) log_warning(options.video + ": ends before the length it promises");
  if (receiver)
    std::printf("sent        %lld packets to %s\n", static_cast<long long>(totals.sent), options.vmc.c_str());
  return kExitOk;
}

}  // namespace

void add_live_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<LiveCommand>();
  CLI::App* command = app.add_subcommand("live", "capture a person while it happens: show it, send the skeleton on");

  command->add_option("--video", options->video, "webcam:N, or a video file or folder of images at its own pace")
      ->required();
  add_camera_options(*command, options->camera, options->fov_deg);
  add_floor_option(*command, options->floor);
  add_background_options(*command, options->background, options->background_frames);
  add_method_options(*command, options->live);
  command->add_option("--vmc", options->vmc, "HOST:PORT that listens to the Virtual Motion Capture protocol");
  command->add_flag("--show", options->show,
                    "the captured surface over the pictures in a window; closing it ends the run");
  command->add_option("--frames", options->frames, "end after this many")->check(at_least(1));
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
