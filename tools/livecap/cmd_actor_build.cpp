// livecap actor build: from pictures of a person to actor.glb. livecap actor views: pictures of an actor to try it on.
#include <cstdio>
#include <memory>
#include <string>

#include "acquire/build_actor.h"
#include "actor/height_range.h"
#include "actor/inspect.h"
#include "base/log.h"
#include "base/text.h"
#include "cmd_actor.h"
#include "eval/capture_folder.h"
#include "livecap/error.h"
#include "method_options.h"
#include "progress.h"
#include "report/actor_report.h"
#include "synth/rehearsal.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

struct ViewsOptions {
  synth::RehearsalOptions views;
  std::string actor;
  std::string unit = "m";
  std::string out;
};

int write_views(const ViewsOptions& options) {
  const Actor actor = load_actor_named(options.actor, 0);
  synth::RehearsalOptions views = options.views;
  if (options.unit != "m") views.unit_mm = acquire::unit_in_mm(options.unit);
  catch_interrupt();
  Progress progress("views");
  synth::write_rehearsal(actor, views, options.out, [&](int done, int total) {
    progress.update(done, total);
    return !interrupted();
  });
  progress.finish();
  if (interrupted()) throw Error("interrupted; " + options.out + " holds a part of the views");
  return kExitOk;
}

struct BuildCommand {
  acquire::BuildOptions build;
  std::string cnn_device, solver_device;
  std::string out;
};

int build(const BuildCommand& options) {
  acquire::BuildOptions build = options.build;
  build.name = std::filesystem::path(options.out).stem().string();
  build.validate();
  require_actor_output(options.out, {{"--mesh", build.mesh},
                                     {"--joints", build.joints},
                                     {"--video", build.turntable.video},
                                     {"--camera", build.turntable.camera}});
  const ocl::DevicePair devices = ocl::select_device_pair(options.cnn_device, options.solver_device);
  ocl::DeviceContext network(devices.cnn), solver(devices.solver);
  catch_interrupt();
  StageProgress progress("actor");
  const acquire::BuildResult result =
      acquire::build_actor(network, solver, build, [&](const std::string& stage, int done, int total) {
        progress.update(stage, done, total);
        return !interrupted();
      });
  progress.finish();
  const std::string bytes = meshing::actor_glb(result.actor);
  write_file_atomically(options.out, bytes);
  const Actor actor = load_actor_bytes(bytes, options.out);
  for (const std::string& note : result.notes) log_warning(note);
  double total_s = 0;
  for (const auto& [name, seconds] : result.stage_s) {
    total_s += seconds;
    std::printf("  %-20s %6.1f s\n", name.c_str(), seconds);
  }
  const std::string facts =
      format("%d vertices from %d views (a person in %d), keypoints agree within %.2f degrees, %.0f s",
             actor.n_vertices(), result.n_views, result.n_detected, result.keypoint_rad * 180 / M_PI, total_s);
  std::vector<std::string> lines = {facts};
  if (std::isfinite(result.overlap)) lines.push_back(format("overlap with the masks %.3f (IoU, mean)", result.overlap));
  if (!result.turn.empty()) lines.push_back(result.turn);
  for (size_t i = 1; i < lines.size(); ++i) std::printf("  %s\n", lines[i].c_str());
  const std::filesystem::path report = std::filesystem::path(options.out).replace_extension(".html");
  write_file_atomically(report, actor_report_html(actor, {build.name, lines, result.notes}));
  std::printf("%s: %s; see %s\n", options.out.c_str(), facts.c_str(), report.c_str());
  return kExitOk;
}

}  // namespace

void add_actor_views_command(CLI::App& actor, Action& action) {
  auto options = std::make_shared<ViewsOptions>();
  CLI::App* command = actor.add_subcommand(
      "views", "pictures of an actor from all around, with cameras, masks and labels: to try `actor build` on");
  command->fallthrough();
  command->add_option("file", options->actor, "actor.glb or builtin:NAME")->required();
  command->add_option("--out", options->out, "folder to write")->required()->check(not_empty());
  command->add_option("--views", options->views.n_views, "how many")
      ->check(between(synth::RehearsalOptions::kViews))
      ->capture_default_str();
  command->add_option("--width", options->views.width, "px")
      ->check(between(synth::RehearsalOptions::kSide))
      ->capture_default_str();
  command->add_option("--picture-height", options->views.height, "px")
      ->check(between(synth::RehearsalOptions::kSide))
      ->capture_default_str();
  command->add_option("--noise", options->views.noise, "sensor noise, 8-bit levels")
      ->check(at_least(0))
      ->capture_default_str();
  command->add_option("--blur", options->views.blur_px, "lens blur, px")->check(at_least(0))->capture_default_str();
  add_camera_unit_option(*command, options->unit);
  command->add_option("--seed", options->views.seed)->check(at_least(0))->capture_default_str();
  command->callback([options, &action] { action = [options] { return write_views(*options); }; });
}

void add_actor_build_command(CLI::App& actor, Action& action) {
  auto options = std::make_shared<BuildCommand>();
  acquire::BuildOptions& build_options = options->build;
  CLI::App* command =
      actor.add_subcommand("build", "make an actor.glb from pictures of a person standing still or turning");
  command->fallthrough();
  command->add_option("--images", build_options.views.images, "folder of pictures from all around");
  command->add_option("--cameras", build_options.views.cameras,
                      "where they were taken: COLMAP text model (folder), OpenCV YAML or Skeletool calibration; looked "
                      "for around --images");
  command->add_flag("--colmap", build_options.colmap,
                    "find the cameras of --images with COLMAP, which must be installed");
  command->add_option("--video", build_options.turntable.video,
                      "instead: the person turns in place once before a static camera, arms and legs held still");
  command->add_option("--camera", build_options.turntable.camera, "camera.json of --video");
  add_fov_option(*command, build_options.turntable.fov_deg,
                 "of --video without --camera: field of view of the longer side, degrees; else 60 is assumed");
  command->add_option("--views", build_options.turntable.n_views, "frames of --video that are used")
      ->check(between({kMinViews, 400}))
      ->capture_default_str();
  command->add_option("--masks", build_options.views.masks, "folder of masks, 255 = person; else the network's");
  command->add_option("--labels", build_options.views.labels, "folder of label images (LIP ids); else guessed");
  CLI::Option* parser =
      command->add_option("--parser", build_options.parser.network,
                          "a human parsing network (.onnx, 20 classes of LIP) that makes the label images");
  command->add_option("--parser-mean", build_options.parser.mean, "its input's mean red green blue, 0..1")
      ->needs(parser)
      ->capture_default_str();
  command->add_option("--parser-std", build_options.parser.deviation, "its input's deviation red green blue, 0..1")
      ->needs(parser)
      ->capture_default_str();
  command->add_flag("--parser-bgr", build_options.parser.bgr, "its first channel is blue")->needs(parser);
  command->add_option("--mesh", build_options.mesh, "a scan (.obj, .ply, .glb) instead of carving");
  command->add_option("--joints", build_options.joints,
                      "joints.json: joints that replace those found from the network");
  command->add_option("--unit", build_options.unit, "of the cameras' or the scan's world: m, cm, mm, inch, auto")
      ->capture_default_str();
  add_height_option(*command, build_options.height_mm, "of the person, metres; sets the scale", kPersonHeightMm);
  command->add_option("--vertices", build_options.target_vertices, "of the actor")
      ->check(between(acquire::BuildOptions::kTargetVertices))
      ->capture_default_str();
  command->add_option("--texture", build_options.texture_size, "side of the texture, px")
      ->check(between(acquire::BuildOptions::kTextureSize))
      ->capture_default_str();
  command->add_option("--grid", build_options.grid_mm, "spacing of the carved volume, mm")
      ->check(between(acquire::BuildOptions::kGridMm))
      ->capture_default_str();
  command->add_flag_callback(
      "--no-refine", [options] { options->build.refine = false; },
      "keep the hull as it is: no search for hollows by colour");
  add_model_option(*command, build_options.model);
  add_device_options(*command, options->cnn_device, options->solver_device);
  command->add_option("--out", options->out, "actor.glb to write")->required();
  command->callback([options, &action] { action = [options] { return build(*options); }; });
}

}  // namespace livecap::tools
