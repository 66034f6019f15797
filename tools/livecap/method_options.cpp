#include "method_options.h"

#include "base/fov_range.h"
#include "value_checks.h"

namespace livecap::tools {

CLI::Option* add_height_option(CLI::App& command, double& height_mm, const std::string& what,
                               const ValueRange& range_mm) {
  return command
      .add_option_function<double>(
          "--height", [&height_mm](double height_m) { height_mm = 1000 * height_m; }, what)
      ->check(between({range_mm.least / 1000, range_mm.most / 1000}, "metres"));
}

CLI::Option* add_fov_option(CLI::App& command, double& fov_deg, const std::string& what) {
  return command.add_option("--fov", fov_deg, what)->check(between(kFovDeg, "degrees"));
}

void add_floor_option(CLI::App& command, std::string& file) {
  command.add_option("--floor", file,
                     "report.json of an earlier capture, the camera not moved since, or camera.json: its floor counts");
}

void add_camera_options(CLI::App& command, std::string& camera, double& fov_deg) {
  CLI::Option* file = command.add_option("--camera", camera, "camera.json");
  add_fov_option(command, fov_deg)->excludes(file);
}

std::vector<CLI::Option*> add_background_options(CLI::App& command, std::string& background, int& n_frames) {
  CLI::Option* picture =
      command.add_option("--background", background, "picture of the empty scene")->check(not_empty());
  CLI::Option* frames =
      command.add_option("--background-frames", n_frames, "the first N frames of the video are empty")
          ->check(at_least(1))
          ->excludes(picture);
  return {picture, frames};
}

CLI::Option* add_model_option(CLI::App& command, std::string& model) {
  return command.add_option("--model", model, "lite, full, heavy or a .tflite file")->capture_default_str();
}

CLI::Option* add_network_device_option(CLI::App& command, std::string& selector) {
  return command.add_option("--cnn-device", selector, "device of the network, as `livecap devices` names it");
}

std::vector<CLI::Option*> add_device_options(CLI::App& command, std::string& cnn_device, std::string& solver_device) {
  return {add_network_device_option(command, cnn_device),
          command.add_option("--solver-device", solver_device, "device of the solvers; each defaults to the other")};
}

std::vector<CLI::Option*> add_frame_options(CLI::App& command, int64_t& first, int64_t& frames) {
  return {command.add_option("--first", first, "first frame of the video")->check(at_least(0)),
          command.add_option("--frames", frames, "at most this many frames of the video")->check(at_least(1))};
}

std::vector<CLI::Option*> add_setting_options(CLI::App& command, MethodOptions& method) {
  std::vector<CLI::Option*> options = {
      add_height_option(command, method.height_mm, "scale the actor to this height, metres"),
      add_model_option(command, method.model),
      command.add_option("--without", method.without, "energy terms and components to switch off, comma-separated")
          ->delimiter(','),
      command
          .add_option("--rigidity", method.rigidity, "material weight of the whole surface, instead of each label's")
          ->check(above(0)),
  };
  for (CLI::Option* option : add_device_options(command, method.cnn_device, method.solver_device))
    options.push_back(option);
  return options;
}

void add_method_options(CLI::App& command, MethodOptions& method) {
  command.add_option("--actor", method.actor, "actor.glb or builtin:NAME")->required();
  command.add_flag_callback(
      "--no-surface", [&method] { method.surface = false; }, "stage I only: the skinned pose");
  add_setting_options(command, method);
}

}  // namespace livecap::tools
