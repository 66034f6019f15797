// livecap capture: a thin client of the public API in include/livecap/capture.h.
#include <cstdio>
#include <memory>
#include <string>

#include "bvh_unit.h"
#include "command.h"
#include "livecap/capture.h"
#include "livecap/error.h"
#include "method_options.h"
#include "progress.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

struct CaptureCommand {
  CaptureOptions capture;
  std::string pace = "fast";
  std::string bvh_unit = "cm";
};

void print_summary(const CaptureReport& report) {
  std::printf("frames      %lld, tracked %lld, damaged %lld, dropped %lld\n", static_cast<long long>(report.frames),
              static_cast<long long>(report.tracked), static_cast<long long>(report.damaged),
              static_cast<long long>(report.dropped));
  if (report.tracked > 0) {  // else there is nothing to measure
    std::printf("speed       %.1f fps, latency %.0f ms (median)\n", report.fps, report.latency_ms);
    std::printf("silhouette  %.3f IoU with the segmented picture (mean over tracked frames)\n", report.mean_iou);
    std::printf("stages     ");
    for (int i = 0; i < kStageCount; ++i) {
      std::printf(" %s %.1f", stage_name(static_cast<CaptureStage>(i)), report.stage_median_ms[i]);
    }
    std::printf(" ms (medians)\n");
  }
  for (const std::string* path : {&report.glb, &report.pc2, &report.bvh, &report.overlay, &report.report}) {
    if (!path->empty()) std::printf("wrote       %s\n", path->c_str());
  }
}

int run(const CaptureCommand& options) {
  CaptureOptions capture = options.capture;
  capture.realtime = options.pace == "realtime";
  capture.bvh_unit_m = bvh_unit_m(options.bvh_unit);

  catch_interrupt();
  Progress learned("capture: learning"), progress("capture");
  const auto learning = [&](int64_t n_seen, int64_t n_frames) {
    learned.update(n_seen, n_frames);
    if (interrupted()) throw Error("interrupted before the first frame");
    return true;
  };
  int64_t done = 0;
  const auto captured = [&](const FrameReport& frame, int64_t n_frames) {
    learned.finish();
    char state[64];
    std::snprintf(state, sizeof(state), "%s IoU %.2f", track_status_name(frame.status), frame.iou);
    progress.update(++done, n_frames, state);
    return !interrupted();
  };
  const CaptureReport report = run_capture(capture, captured, learning);
  progress.finish();
  print_summary(report);
  for (const std::string& warning : report.warnings) std::printf("warning     %s\n", warning.c_str());
  if (interrupted() && !report.complete) throw Error("interrupted after " + std::to_string(done) + " frames");
  return kExitOk;
}

}  // namespace

void add_capture_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<CaptureCommand>();
  CaptureOptions& capture = options->capture;
  CLI::App* command = app.add_subcommand("capture", "capture a person in a video: pose and deforming surface");

  command->add_option("--video", capture.video, "video file, folder of images, or webcam:N")->required();
  add_camera_options(*command, capture.camera, capture.fov_deg);
  add_floor_option(*command, capture.floor);
  add_background_options(*command, capture.background, capture.background_frames);
  command->add_option("--out", capture.out, "folder to write")->required();
  command->add_flag("--overlay", capture.overlay, "also write overlay.mp4");

  add_method_options(*command, capture);
  command->add_option("--detections", capture.detections, "detections.jsonl to use instead of the network");
  command
      ->add_option("--miss-detections", capture.missed_detections,
                   "test of robustness: show the network nothing in this share of the frames, chosen at random")
      ->check(between({0, 1}));
  command
      ->add_option("--draw", capture.draw,
                   "test of chance: move the network's first crop aside by N hundredths of a pixel")
      ->check(between({0, 99}));
  command->add_flag("--smooth", capture.smooth, "filter the result with [0.15, 0.7, 0.15] over time once more");

  command->add_flag("--sequential", capture.sequential, "one thread; the result is the same");
  command->add_option("--pace", options->pace, "fast: every frame; realtime: as a camera would deliver them")
      ->check(CLI::IsMember({"fast", "realtime"}))
      ->capture_default_str();
  add_frame_options(*command, capture.first, capture.frames);
  command
      ->add_option("--learn-frames", capture.learn_frames,
                   "look at so many frames beforehand, to learn floor and light; 0: on the way, as live")
      ->check(at_least(0))
      ->capture_default_str();
  add_bvh_unit_option(*command, options->bvh_unit);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
