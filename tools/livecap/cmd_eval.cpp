// livecap eval: compares a capture with the ground truth of its sequence.
#include <cstdio>
#include <memory>
#include <string>

#include "base/text.h"
#include "command.h"
#include "eval/evaluate.h"

namespace livecap::tools {
namespace {

struct Options {
  EvalOptions eval;
  bool json = false;
  std::string out;
};

int run(const Options& options) {
  const EvalReport report = evaluate(options.eval);
  if (!options.out.empty()) write_file_atomically(options.out, eval_report_json(report));
  std::fputs((options.json ? eval_report_json(report) : eval_report_text(report)).c_str(), stdout);
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
  command->add_flag("--json", options->json, "print everything, frame by frame, as JSON");
  command->add_option("--out", options->out, "also write the JSON to this file");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
