// livecap actor: looks at actor files and makes them (cmd_actor_build.cpp).
#include "cmd_actor.h"

#include <cstdio>
#include <memory>
#include <string>

#include "actor/actor.h"
#include "actor/inspect.h"
#include "eval/compare_actors.h"

namespace livecap::tools {
namespace {

struct Options {
  std::string file;
  std::string truth;
  double height_m = 0;
};

int compare(const Options& options) {
  const Actor built = load_actor(options.file, options.height_m * 1000), truth = load_actor(options.truth);
  std::fputs(comparison_report(compare_actors(built, truth)).c_str(), stdout);
  return kExitOk;
}

int inspect(const Options& options) {
  const Actor actor = load_actor(options.file, options.height_m * 1000);
  std::fputs(inspect_actor(actor).c_str(), stdout);
  return kExitOk;
}

}  // namespace

void add_actor_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("actor", "look at an actor file, or make one");
  command->require_subcommand(1);
  CLI::App* inspect_command =
      command->add_subcommand("inspect", "print what was found in an actor.glb, what was defaulted, what is wrong");
  inspect_command->fallthrough();
  inspect_command->add_option("file", options->file, "actor.glb")->required();
  inspect_command->add_option("--height", options->height_m, "scale it to this height, metres")
      ->check(CLI::PositiveNumber);
  inspect_command->callback([options, &action] { action = [options] { return inspect(*options); }; });
  CLI::App* compare_command =
      command->add_subcommand("compare", "how far an actor is from a true one: surface, joints, posing, materials");
  compare_command->fallthrough();
  compare_command->add_option("file", options->file, "actor.glb")->required();
  compare_command->add_option("truth", options->truth, "the true actor.glb")->required();
  compare_command->callback([options, &action] { action = [options] { return compare(*options); }; });
  add_actor_build_command(*command, action);
  add_actor_views_command(*command, action);
  add_actor_fit_command(*command, action);
}

}  // namespace livecap::tools
