// livecap actor: looks at actor files and makes them (cmd_actor_build.cpp).
#include "cmd_actor.h"

#include <cstdio>
#include <memory>
#include <string>

#include "acquire/person_frame.h"
#include "actor/actor.h"
#include "actor/inspect.h"
#include "base/require_writable.h"
#include "base/text.h"
#include "cloth/folds.h"
#include "cloth/hanging_cloth.h"
#include "eval/capture_folder.h"
#include "eval/compare_actors.h"
#include "livecap/error.h"
#include "method_options.h"
#include "ocl/context.h"
#include "report/actor_report.h"
#include "texture/surface_views.h"

namespace livecap::tools {
namespace {

struct Options {
  std::string file;
  std::string truth;
  std::string views;  // cameras of the pictures
  std::string unit = "m";
  std::string html;
  double height_mm = 0;
};

int compare(const Options& options) {
  if (!options.html.empty()) require_writable(options.html);
  require_apart({{"the actor", options.file}, {"the true one", options.truth}}, {options.html}, "--html");
  const Actor built = load_actor_named(options.file, options.height_mm);
  const Actor truth = load_actor_named(options.truth, 0);
  std::vector<char> seen;
  if (!options.views.empty()) {
    ocl::DeviceContext device(ocl::select_device_pair({}, {}).solver);
    seen = visible_hull_vertices(device, truth.mesh, options.views, std::filesystem::path(options.views) / "masks",
                                 acquire::unit_in_mm(options.unit));
  }
  const ActorComparison comparison = compare_actors(built, truth, 20, seen);
  const std::string text = comparison_report(comparison);
  if (!options.html.empty())
    write_file_atomically(options.html, comparison_html(built, text, comparison.distances_mm, comparison.hidden));
  std::fputs(text.c_str(), stdout);
  return kExitOk;
}

// How capture takes what hangs off the legs; empty for who wears nothing like it.
std::string hanging_cloth_text(const Actor& actor) {
  int n = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) n += hangs(actor, i);
  if (n == 0) return {};
  const float loose = looseness(actor, {});
  const std::string taken = loose == 0 ? "taken for taut: it hangs from the hips in its shape, and legs push it"
                            : loose == 1
                                ? "taken for loose, in folds: it hangs from the hips, and legs push it"
                                : format("taken for %.0f %% loose: its shape holds it that much less", 100 * loose);
  return format("\nhanging cloth: %d vertices, its girth is %.1f %% more than the shortest way around; %s\n", n,
                100 * share_in_folds(actor), taken.c_str());
}

int inspect(const Options& options) {
  const Actor actor = load_actor_named(options.file, options.height_mm);
  std::fputs((inspect_actor(actor) + hanging_cloth_text(actor)).c_str(), stdout);
  return kExitOk;
}

}  // namespace

void require_actor_output(const std::string& out, const std::vector<InputFile>& inputs) {
  const std::filesystem::path file = out;
  if (file.extension() != ".glb") throw ConfigError("--out " + out + ": must end with .glb");
  const std::filesystem::path report = std::filesystem::path(file).replace_extension(".html");
  for (const std::filesystem::path& written : {file, report}) require_writable(written);
  require_apart(inputs, {file, report});
}

void add_camera_unit_option(CLI::App& command, std::string& unit) {
  command.add_option("--unit", unit, "of the cameras' world")
      ->check(CLI::IsMember({"m", "cm", "mm", "inch"}))
      ->capture_default_str();
}

void add_actor_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("actor", "look at an actor file, or make one");
  command->require_subcommand(1);
  CLI::App* inspect_command =
      command->add_subcommand("inspect", "print what was found in an actor.glb, what was defaulted, what is wrong");
  inspect_command->fallthrough();
  inspect_command->add_option("file", options->file, "actor.glb or builtin:NAME")->required();
  add_height_option(*inspect_command, options->height_mm, "scale it to this height, metres");
  inspect_command->callback([options, &action] { action = [options] { return inspect(*options); }; });
  CLI::App* compare_command =
      command->add_subcommand("compare", "how far an actor is from a true one: surface, joints, posing, materials");
  compare_command->fallthrough();
  compare_command->add_option("file", options->file, "actor.glb or builtin:NAME")->required();
  compare_command->add_option("truth", options->truth, "the true one: actor.glb or builtin:NAME")->required();
  compare_command->add_option("--views", options->views,
                              "the folder of `actor views` with cameras and masks of the truth: also print the figures "
                              "without concavities and what no camera sees");
  add_camera_unit_option(*compare_command, options->unit);
  compare_command->add_option("--html", options->html, "also write a report with a heat map to this file");
  compare_command->callback([options, &action] { action = [options] { return compare(*options); }; });
  add_actor_build_command(*command, action);
  add_actor_views_command(*command, action);
  add_actor_import_command(*command, action);
  add_actor_fit_command(*command, action);
}

}  // namespace livecap::tools
