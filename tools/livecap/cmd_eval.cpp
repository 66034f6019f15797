// livecap eval: compares a capture with the ground truth of its sequence.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "command.h"
#include "eval/bars.h"
#include "eval/evaluate.h"
#include "eval/extra_view.h"
#include "eval/html_report.h"
#include "livecap/error.h"

namespace livecap::tools {
namespace {

struct Options {
  EvalOptions eval;
  std::vector<std::pair<std::string, std::string>> views;  // camera file, folder of masks
  std::string pose_only;
  std::string html;
  std::string video;
  bool json = false;
  std::string out;
};

// The report with the bars as its first field.
std::string with_bars(const std::string& report_json, const std::vector<Bar>& bars) {
  return "{\n\"bars\": " + bars_json(bars) + "," + report_json.substr(1);
}

int run(Options options) {
  for (const auto& [camera, masks] : options.views) options.eval.views.push_back(open_view(camera, masks));
  const EvalReport report = evaluate(options.eval);
  std::optional<EvalReport> pose_only;
  if (!options.pose_only.empty()) {
    EvalOptions pose = options.eval;
    pose.capture = options.pose_only;
    pose_only = evaluate(pose);
  }
  const std::vector<Bar> bars = judge_bars(report, pose_only ? &*pose_only : nullptr);
  const std::string json = with_bars(eval_report_json(report), bars);
  if (!options.html.empty()) {
    const HtmlReport page{options.eval, options.video, report, pose_only ? &*pose_only : nullptr, nullptr, bars};
    write_file_atomically(options.html, html_report(page));
  }
  if (!options.out.empty()) write_file_atomically(options.out, json);
  std::fputs((options.json ? json : eval_report_text(report) + bars_text(bars)).c_str(), stdout);
  return kExitOk;
}

}  // namespace

void add_eval_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("eval", "compare a capture with ground truth");
  command->add_option("--capture", options->eval.capture, "folder that `livecap capture` wrote")->required();
  command->add_option("--truth", options->eval.truth, "folder with vertices.pc2, joints.json, masks/")->required();
  command->add_option("--actor", options->eval.actor, "actor of the capture, when its report.json names none");
  command->add_option("--camera", options->eval.camera, "camera of the capture, when its report.json names none");
  command->add_option("--view", options->views, "CAMERA.json MASKS_DIR of a further camera; repeatable");
  command->add_option("--pose-only", options->pose_only,
                      "capture of the same video with --no-surface: what the surface stage is compared with");
  command->add_option("--html", options->html, "also write a report with curves and pictures to this file");
  command->add_option("--video", options->video, "video of the capture for the pictures, when not that of report.json");
  command->add_flag("--json", options->json, "print everything, frame by frame, as JSON");
  command->add_option("--out", options->out, "also write the JSON to this file");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
