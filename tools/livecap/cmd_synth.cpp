// livecap synth: makes a sequence with ground truth from a built-in actor.
#include <cstdio>
#include <memory>
#include <string>
#include <tuple>

#include "base/joined.h"
#include "base/text.h"
#include "command.h"
#include "livecap/error.h"
#include "method_options.h"
#include "progress.h"
#include "synth/named_actor.h"
#include "synth/synth.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

struct SynthCommand {
  SynthOptions synth;
  std::string actor = "builtin:skirt";
  double distance_m = 3.6;
  bool no_cloth = false;
  std::string out;
};

int run(const SynthCommand& options) {
  SynthOptions synth = options.synth;
  synth.actor = builtin_actor_name(options.actor);
  synth.distance_mm = options.distance_m * 1000;
  synth.cloth = !options.no_cloth;

  catch_interrupt();
  Progress progress("synth");
  const SynthReport report = write_sequence(synth, options.out, [&](int frame, int n_frames) {
    progress.update(frame, n_frames);
    return !interrupted();
  });
  progress.finish();
  if (interrupted()) throw Error("interrupted; " + options.out + " holds a part of the sequence");

  std::printf("%s: %d frames, %d vertices, cloth %.0f mm from the skin on average (95 %%: %.0f mm), %.0f ms a frame\n",
              options.out.c_str(), report.n_frames, report.n_vertices, report.cloth_mean_mm, report.cloth_p95_mm,
              report.render_ms_per_frame);
  return kExitOk;
}

}  // namespace

void add_synth_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<SynthCommand>();
  SynthOptions& synth = options->synth;
  CLI::App* command = app.add_subcommand("synth", "make a sequence with ground truth from a built-in actor");
  command->add_option("--actor", options->actor, "builtin:NAME, NAME one of " + joined(builtin_actor_names()))
      ->capture_default_str();
  add_height_option(*command, synth.height_mm, "height of the actor, metres")
      ->default_str(format("%g", synth.height_mm / 1000));
  for (const auto& [name, share, what] :
       {std::tuple{"--legs", &synth.physique.legs, "length of the legs"},
        std::tuple{"--arms", &synth.physique.arms, "length of the arms"},
        std::tuple{"--trunk", &synth.physique.trunk, "length of the trunk"},
        std::tuple{"--shoulders", &synth.physique.shoulders, "width of the shoulders"},
        std::tuple{"--girth", &synth.physique.girth, "girth of trunk and limbs"}})
    command->add_option(name, *share, std::string(what) + " relative to the built-in actor's")->capture_default_str();
  command->add_option("--motion", synth.motions, "one or more of " + joined(motion_names()))->delimiter(',');
  command
      ->add_option("--crouch", synth.crouch_deg,
                   "who stands has thighs so many degrees forwards and knees bent by twice that, 0 to 40")
      ->capture_default_str();
  command->add_option("--scenario", synth.scenario, "what makes it difficult: one of " + joined(scenario_names()))
      ->capture_default_str();
  command->add_option("--out", options->out, "folder to write")->required()->check(not_empty());
  command->add_option("--frames", synth.n_frames, "frames of the video; 0: until the motions end");
  command->add_option("--empty-frames", synth.empty_frames, "frames with nobody at the start")->capture_default_str();
  command->add_option("--width", synth.width, "px")->capture_default_str();
  command->add_option("--picture-height", synth.height, "px")->capture_default_str();
  command->add_option("--fps", synth.fps)->capture_default_str();
  command->add_option("--fov", synth.fov_deg, "field of view of the longer side, degrees")->capture_default_str();
  command->add_option("--distance", options->distance_m, "camera to actor, metres")->capture_default_str();
  command->add_option("--noise", synth.noise, "sensor noise, 8-bit levels")->capture_default_str();
  command->add_option("--seed", synth.seed, "of noise and room")
      ->check(at_least(0))
      ->check(whole_number())
      ->capture_default_str();
  command->add_flag("--floor", synth.floor, "camera.json also says where the floor is");
  command->add_flag("--no-cloth", options->no_cloth, "skinning only, no cloth simulation");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
