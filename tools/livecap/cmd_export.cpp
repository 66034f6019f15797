// livecap export: a finished capture for other programs, upright on its floor.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "base/text.h"
#include "bvh_unit.h"
#include "command.h"
#include "level/level_export.h"
#include "livecap/error.h"
#include "method_options.h"
#include "progress.h"

namespace livecap::tools {
namespace {

struct ExportCommand {
  LevelExportOptions level;
  std::string capture;
  std::vector<std::string> out;
  std::string bvh_unit = "cm";
};

std::string floor_text(const LevelExportReport& report) {
  if (report.floor == FloorSource::kLevelCamera)
    return "the camera is taken to be level, and the lowest vertex to be on the floor";
  return format("floor %s: the camera is %.2f m above it, looks %.1f degrees %s and is rolled by %.1f",
                report.floor == FloorSource::kMeasured ? "as it was given" : "below feet at rest",
                report.camera_height_mm / 1000, std::abs(report.tilt.down_deg),
                report.tilt.down_deg < 0 ? "up" : "down", report.tilt.roll_deg);
}

int run(const ExportCommand& options) {
  LevelExportOptions level = options.level;
  level.capture = options.capture;
  level.bvh_unit_m = bvh_unit_m(options.bvh_unit);
  level.out.assign(options.out.begin(), options.out.end());
  catch_interrupt();
  const LevelExportReport report = export_level(level, [] { return !interrupted(); });
  if (report.files < options.out.size()) throw Error("interrupted; " + options.out[report.files] + " was not written");
  for (const std::string& out : options.out)
    std::printf("%s: %lld frames, the person in %lld of them\n", out.c_str(), static_cast<long long>(report.frames),
                static_cast<long long>(report.tracked));
  std::printf("%s\n", floor_text(report).c_str());
  return kExitOk;
}

}  // namespace

void add_export_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExportCommand>();
  LevelExportOptions& level = options->level;
  CLI::App* command = app.add_subcommand("export", "a capture for other programs, upright on its floor");
  command->add_option("--capture", options->capture, "folder that `livecap capture` wrote")->required();
  command->add_option("--out", options->out, "FILE.glb, FILE.bvh or FILE.pc2; repeatable")->required();
  command->add_option("--actor", level.actor, "actor of the capture, when not that of its report.json");
  CLI::Option* floor = command->add_option(
      "--floor", level.floor, "camera.json or report.json whose floor counts, e.g. one measured after the capture");
  command->add_flag("--level", level.level_camera, "take the camera to be level, whatever the feet show")
      ->excludes(floor);
  add_frame_options(*command, level.first, level.frames);
  add_bvh_unit_option(*command, options->bvh_unit);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
