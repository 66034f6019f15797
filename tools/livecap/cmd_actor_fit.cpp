// livecap actor fit: a built-in actor with the proportions and colours of the person in a video.
#include <cstdio>
#include <memory>
#include <string>

#include "actor/height_range.h"
#include "base/log.h"
#include "base/text.h"
#include "cmd_actor.h"
#include "fit/fit_actor.h"
#include "method_options.h"
#include "progress.h"
#include "report/actor_report.h"
#include "synth/named_actor.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

struct FitCommand {
  FitActorOptions fit;
  std::string actor = "builtin:trousers";
  std::string cnn_device, solver_device;
  std::string out;
};

int fit(const FitCommand& command) {
  FitActorOptions options = command.fit;
  options.actor = builtin_actor_name(command.actor);
  options.validate();
  require_actor_output(
      command.out, {{"--video", options.video}, {"--camera", options.camera}, {"--background", options.background}});
  const ocl::DevicePair devices = ocl::select_device_pair(command.cnn_device, command.solver_device);
  ocl::DeviceContext network(devices.cnn), solver(devices.solver);
  catch_interrupt();
  StageProgress progress("actor");
  const auto update = [&](const std::string& stage, int done, int total) {
    progress.update(stage, done, total);
    return !interrupted();
  };
  FitFootage footage = read_footage(network, solver, options, update);
  FitResult result = fit_actor(solver, std::move(footage), options, update);
  progress.finish();
  result.actor.name = std::filesystem::path(command.out).stem().string();
  const std::string bytes = meshing::actor_glb(result.actor);
  write_file_atomically(command.out, bytes);
  const Actor actor = load_actor_bytes(bytes, command.out);
  for (const std::string& note : result.notes) log_warning(note);
  for (int k = 0; k < kProportionCount; ++k)
    std::printf("  %-17s %+6.1f %%\n", kProportionNames[k], 100 * (result.scales[k] - 1));
  const std::string facts = format(
      "silhouette overlap %.3f, with %s %.3f, over %d of %d frames; %.0f %% of the surface seen", result.overlap_after,
      command.actor.c_str(), result.overlap_before, result.n_used, result.n_looked_at, 100 * result.seen_share);
  const std::filesystem::path report = std::filesystem::path(command.out).replace_extension(".html");
  write_file_atomically(report, actor_report_html(actor, {result.actor.name, {facts}, result.notes}));
  std::printf("%s: %s; see %s\n", command.out.c_str(), facts.c_str(), report.c_str());
  return kExitOk;
}

}  // namespace

void add_actor_fit_command(CLI::App& actor, Action& action) {
  auto options = std::make_shared<FitCommand>();
  FitActorOptions& fit_options = options->fit;
  CLI::App* command =
      actor.add_subcommand("fit", "give a built-in actor the proportions and colours of the person in a video");
  command->fallthrough();
  command->add_option("--video", fit_options.video, "video file or folder of images, a few seconds")->required();
  add_camera_options(*command, fit_options.camera, fit_options.fov_deg);
  add_background_options(*command, fit_options.background, fit_options.background_frames);
  command->add_option("--actor", options->actor, "builtin:NAME, what the person wears")->capture_default_str();
  add_height_option(*command, fit_options.height_mm, "of the person, metres; one view does not tell it",
                    kPersonHeightMm);
  command->add_option("--frames", fit_options.max_frames, "look at so many frames at most")
      ->check(at_least(1))
      ->capture_default_str();
  command->add_option("--fit-frames", fit_options.n_frames, "fit to about so many of them")
      ->check(between(FitActorOptions::kFitFrames))
      ->capture_default_str();
  add_model_option(*command, fit_options.model);
  add_device_options(*command, options->cnn_device, options->solver_device);
  command->add_option("--out", options->out, "actor.glb to write")->required();
  command->callback([options, &action] { action = [options] { return fit(*options); }; });
}

}  // namespace livecap::tools
