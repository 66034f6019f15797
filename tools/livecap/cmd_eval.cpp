// livecap eval: compares a capture with the ground truth of its sequence; --ablate makes the captures itself.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ablate.h"
#include "base/require_apart.h"
#include "base/require_writable.h"
#include "base/scratch_folder.h"
#include "base/text.h"
#include "command.h"
#include "eval/bars.h"
#include "eval/capture_folder.h"
#include "eval/evaluate.h"
#include "eval/extra_view.h"
#include "livecap/capture.h"
#include "livecap/error.h"
#include "method_options.h"
#include "progress.h"
#include "report/html_report.h"
#include "value_checks.h"

namespace livecap::tools {
namespace {

namespace fs = std::filesystem;

struct EvalCommand {
  EvalOptions eval;
  std::vector<std::pair<std::string, std::string>> views;  // camera file, folder of masks
  std::string pose_only;
  std::string html;
  std::string out;
  bool json = false;
  bool ablate = false;
  int draws = 1;           // of each row of --ablate
  CaptureOptions capture;  // of --ablate; its video also of --html
};

// Fields put before those of a report.
std::string with_fields(const std::string& report_json,
                        const std::vector<std::pair<std::string, std::string>>& fields) {
  std::string json = "{\n";
  for (const auto& [name, value] : fields) json += "\"" + name + "\": " + value + ",\n";
  return json + report_json.substr(report_json.find('{') + 1);
}

int finish(const EvalCommand& options, const EvalOptions& pictured, const EvalReport& report,
           const EvalReport* pose_only, const Ablation* ablation) {
  const std::vector<Bar> bars = judge_bars(report, pose_only);
  if (!options.html.empty()) {
    write_file_atomically(options.html,
                          html_report({pictured, options.capture.video, report, pose_only, ablation, bars}));
  }
  std::vector<std::pair<std::string, std::string>> fields = {{"bars", bars_json(bars)}};
  if (ablation) fields.emplace_back("ablation", ablation_json(*ablation));
  const std::string json = with_fields(eval_report_json(report), fields);
  if (!options.out.empty()) {
    const fs::path file = ablation ? fs::path(options.out) / "ablation.json" : fs::path(options.out);
    write_file_atomically(file, json);
  }
  if (options.json) {
    std::fputs(json.c_str(), stdout);
  } else {
    std::fputs(((ablation ? ablation_text(*ablation) : eval_report_text(report)) + bars_text(bars)).c_str(), stdout);
  }
  return kExitOk;
}

int run_one(const EvalCommand& options) {
  if (options.eval.capture.empty()) throw ConfigError("--capture is missing: a folder that `livecap capture` wrote");
  const EvalReport report = evaluate(options.eval);
  std::optional<EvalReport> pose_only;
  if (!options.pose_only.empty()) {
    EvalOptions pose = options.eval;
    pose.capture = options.pose_only;
    pose_only = evaluate(pose);
  }
  return finish(options, options.eval, report, pose_only ? &*pose_only : nullptr, nullptr);
}

int run_all(EvalCommand options) {
  if (!options.eval.capture.empty())
    throw ConfigError("--ablate makes its captures itself: give --video, not --capture");
  if (!options.pose_only.empty()) throw ConfigError("--ablate makes its captures itself: no --pose-only");
  std::optional<ScratchFolder> scratch;
  if (options.out.empty()) scratch.emplace();
  options.capture.out = scratch ? scratch->path().string() : options.out;
  options.capture.camera = options.eval.camera;
  options.capture.actor = options.eval.actor;
  const Ablation ablation = run_ablation(options.capture, options.eval, options.draws, !options.out.empty());
  EvalOptions pictured = options.eval;
  pictured.capture = full_capture_folder(options.capture);
  return finish(options, pictured, ablation.rows[ablation.full].draws.front(),
                &ablation.rows[ablation.pose_only].draws.front(), &ablation);
}

// The captures, the truth and the sequence that it lies in stay what was compared.
void require_inputs_kept(const EvalCommand& options) {
  std::vector<InputFile> inputs = capture_inputs("--capture", options.eval.capture);
  for (const InputFile& input : capture_inputs("--pose-only", options.pose_only)) inputs.push_back(input);
  const auto add_masks = [&inputs](const char* option, const fs::path& folder) {
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
      inputs.push_back({option, entry.path()});
  };
  const fs::path& truth = options.eval.truth;
  for (const char* name : {"vertices.pc2", "joints.json", "labels.npy", "../actor.glb", "../background.png",
                           "../camera.json", "../video.mp4"})
    inputs.push_back({"--truth", truth / name});
  add_masks("--truth", truth / "masks");
  for (const auto& [camera, masks] : options.views) {
    inputs.push_back({"--view", camera});
    add_masks("--view", masks);
  }
  for (const auto& [option, file] : {std::pair{"--actor", options.eval.actor},
                                     {"--camera", options.eval.camera},
                                     {"--truth-actor", options.eval.truth_actor},
                                     {"--video", options.capture.video},
                                     {"--background", options.capture.background}})
    inputs.push_back({option, file});
  fs::path json = options.out;
  if (options.ablate && !options.out.empty()) json /= "ablation.json";
  require_apart(inputs, {options.html, json}, "--html or --out");
}

int run(EvalCommand options) {
  catch_interrupt();
  options.eval.go_on = [] { return !interrupted(); };
  for (const auto& [camera, masks] : options.views) options.eval.views.push_back(open_view(camera, masks));
  if (!options.html.empty()) require_writable(options.html);
  if (!options.ablate && !options.out.empty()) require_writable(options.out);
  require_inputs_kept(options);
  return options.ablate ? run_all(std::move(options)) : run_one(options);
}

}  // namespace

void add_eval_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<EvalCommand>();
  CaptureOptions& capture = options->capture;
  CLI::App* command = app.add_subcommand("eval", "compare a capture with ground truth");
  command->add_option("--capture", options->eval.capture, "folder that `livecap capture` wrote");
  command->add_option("--truth", options->eval.truth, "folder with vertices.pc2, joints.json, masks/")->required();
  command->add_option("--actor", options->eval.actor, "actor of the capture, when its report.json names none");
  command->add_option("--camera", options->eval.camera, "camera of the capture, when its report.json names none");
  command->add_option("--truth-actor", options->eval.truth_actor,
                      "actor whose mesh the true vertices are of; else actor.glb beside the truth folder, if any");
  command->add_option("--view", options->views, "CAMERA.json MASKS_DIR of a further camera; repeatable");
  command->add_option("--pose-only", options->pose_only,
                      "capture of the same video with --no-surface: what the surface stage is compared with");
  command->add_flag("--json", options->json, "print everything, frame by frame, as JSON");
  command->add_option("--html", options->html, "also write a report with curves and pictures to this file");
  command->add_option("--out", options->out,
                      "also write the JSON to this file; with --ablate: folder that keeps captures and JSON");
  command->add_option("--video", capture.video, "video for the pictures, when not that of report.json; or of --ablate");

  const std::string group = "Ablation";
  CLI::Option* const ablate =
      command->add_flag("--ablate", options->ablate, "capture --video with parts of the method off, print one table");
  ablate->group(group);
  std::vector<CLI::Option*> of_ablate = {
      command
          ->add_option("--draws", options->draws,
                       "capture each row so often, with other draws of the network's detections; the table has the "
                       "means, all else is of the first")
          ->check(between({1, 100}))
          ->capture_default_str(),
      add_fov_option(*command, capture.fov_deg),
      command->add_flag("--smooth", capture.smooth, "filter the result with [0.15, 0.7, 0.15] over time once more"),
  };
  for (const auto& more :
       {add_background_options(*command, capture.background, capture.background_frames),
        add_setting_options(*command, capture), add_frame_options(*command, capture.first, capture.frames)})
    of_ablate.insert(of_ablate.end(), more.begin(), more.end());
  for (CLI::Option* option : of_ablate) option->group(group)->needs(ablate);
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
