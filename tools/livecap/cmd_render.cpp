// livecap render: pictures and films of a capture.
#include <cstdio>
#include <memory>
#include <string>
#include <tuple>

#include "base/joined.h"
#include "base/text.h"
#include "command.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "method_options.h"
#include "progress.h"
#include "render/picture_sink.h"
#include "render/render_capture.h"

namespace livecap::tools {
namespace {

struct RenderCommand {
  render::RenderOptions render;
  std::string size;
  std::string sheet;
  bool no_floor = false;
};

// "540x960"; an empty text leaves both as they are.
void parse_pair(const char* option, const std::string& text, int& first, int& second) {
  if (text.empty()) return;
  int end = 0;
  if (std::sscanf(text.c_str(), "%6dx%6d%n", &first, &second, &end) != 2 || end != static_cast<int>(text.size()) ||
      first < 1 || second < 1)
    throw ConfigError(std::string(option) + " " + text + ": expected two numbers above 0 such as 4x3");
}

int run(const RenderCommand& options) {
  render::RenderOptions render = options.render;
  parse_pair("--size", options.size, render.width, render.height);
  parse_pair("--sheet", options.sheet, render.sheet_columns, render.sheet_rows);
  render.floor = !options.no_floor;

  const ImageThreads one_thread(1);
  catch_interrupt();
  Progress progress("render");
  const render::RenderReport report = render_capture(render, [&](int64_t done, int64_t total) {
    progress.update(done, total);
    return !interrupted();
  });
  progress.finish();
  std::printf("%s: %lld pictures of %dx%d", render.out.c_str(), static_cast<long long>(report.pictures), report.width,
              report.height);
  if (render::output_kind(render.out) == render::OutputKind::kFilm) std::printf(", %g a second", report.fps);
  if (report.empty > 0) std::printf(", %lld of them without the person", static_cast<long long>(report.empty));
  std::printf("\n");
  if (!report.complete)
    throw Error(format("interrupted; %s holds the first %lld pictures", render.out.c_str(),
                       static_cast<long long>(report.pictures)));
  return kExitOk;
}

}  // namespace

void add_render_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<RenderCommand>();
  render::RenderOptions& render = options->render;
  CLI::App* command = app.add_subcommand("render", "pictures and films of a capture, also from other sides");
  command->add_option("--capture", render.capture, "folder that `livecap capture` wrote")->required();
  command->add_option("--out", render.out, "FILE.mp4, a folder for PNG files, or FILE.png for one picture")->required();
  command->add_option("--actor", render.actor, "actor of the capture, when not that of its report.json");
  command->add_option("--camera", render.camera, "camera of the capture, when not that of its report.json");
  command->add_option("--video", render.video, "video of the capture, when not that of its report.json");

  const std::string from = "From where";
  command->add_option("--view", render.view, "one of " + joined(render::view_names()))
      ->capture_default_str()
      ->group(from);
  for (const auto& [name, value, what] :
       {std::tuple{"--azimuth", &render.azimuth_deg,
                   "about the person, degrees: 0 where the camera stands, 90 at the left of who faces it"},
        std::tuple{"--elevation", &render.elevation_deg, "about the person, degrees above the horizon"},
        std::tuple{"--distance", &render.distance_m, "to the person, metres; else so that everything is seen"}})
    command->add_option(name, *value, what)->group(from);
  command->add_flag("--orbit", render.orbit, "once around the person while the clip lasts")->group(from);

  const std::string look = "Look";
  command->add_option("--style", render.style, "one of " + joined(render::style_names()))
      ->capture_default_str()
      ->group(look);
  command
      ->add_option("--scale", render.scale_mm,
                   format("displacement that has the last colour, mm; default: %g", render::kScaleMm))
      ->group(look);
  command->add_option("--opacity", render.opacity, "of the person, 0 to 1")->capture_default_str()->group(look);
  command->add_flag("--skeleton", render.skeleton, "the bones over it")->group(look);
  command
      ->add_option("--background", render.background,
                   "video, none (transparent PNG), '#rrggbb' or a picture; default: the video in the camera's view")
      ->group(look);
  command->add_flag("--no-floor", options->no_floor, "no grid and shadow about the person")->group(look);
  command->add_flag("--side-by-side", render.side_by_side, "the video at the left")->group(look);

  const std::string pictures = "Pictures";
  command->add_option("--size", options->size, "WxH of a picture, px; default: the camera's")->group(pictures);
  command->add_option("--samples", render.samples, "per pixel, in either direction")
      ->capture_default_str()
      ->group(pictures);
  command->add_option("--fps", render.fps, "of the film; default: it lasts as long as the video")->group(pictures);
  for (CLI::Option* option : add_frame_options(*command, render.first, render.frames)) option->group(pictures);
  command->add_option("--every", render.every, "only every Nth of them")->group(pictures);
  command->add_option("--sheet", options->sheet, "COLUMNSxROWS pictures of the clip, evenly chosen, in one FILE.png")
      ->group(pictures);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
