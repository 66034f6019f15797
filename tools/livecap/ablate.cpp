#include "ablate.h"

#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eval/truth_folder.h"
#include "livecap/error.h"
#include "progress.h"

namespace livecap::tools {
namespace {

constexpr std::string_view kFullFolder = "full";

// What one run of the table leaves out, and what the paper found.
struct Variant {
  const char* folder;
  const char* name;
  const char* group;
  std::vector<std::string> without;
  bool surface = true;
  double rigidity = 0;
  const char* paper = "";
};

constexpr const char* kBaseline = "Baselines";
constexpr const char* kStages = "Stages";
constexpr const char* kParts = "Everything without ...";

const std::vector<Variant>& variants() {
  static const std::vector<Variant> list = {
      {"network_rigged", "network only, rigged by inverse kinematics", kBaseline, {"pose_solver"}, false},
      {"no_face",
       "2D without face + 3D",
       kStages,
       {"pose_silhouette", "match", "shading", "floor", "face"},
       false,
       0,
       "head turned wrongly"},
      {"kinematic",
       "2D + 3D (kinematic fit)",
       kStages,
       {"pose_silhouette", "match", "shading", "floor"},
       false,
       0,
       "overlay misaligned"},
      {"pose", "full pose (pose only)", kStages, {}, false, 0, "about 20 mm more on the skirt"},
      {"full", "pose + surface (all)", kStages, {}, true, 0, "lowest error"},
      {"no_warping", "displacement warping", kParts, {"warping"}, true, 0, "2.4 %"},
      {"no_part_mask", "body part mask", kParts, {"part_mask"}, true, 0, "1.7 %"},
      {"no_snapping", "vertex snapping", kParts, {"snapping"}, true, 0, "1.7 %"},
      {"no_cloth", "simulation of hanging cloth", kParts, {"cloth"}},
      {"no_photo", "photometric term", kParts, {"photo"}},
      {"no_match", "texture matching", kParts, {"match"}},
      {"no_shading", "skin shading", kParts, {"shading"}},
      {"no_floor", "floor under the feet", kParts, {"floor"}},
      {"no_rest", "chest and collarbones drawn to rest", kParts, {"rest"}},
      {"no_depth", "surface held along the line of sight", kParts, {"depth"}},
      {"rigidity_2", "material weights: constant 2.0", kParts, {}, true, 2, "head distorted"},
      {"rigidity_50", "material weights: constant 50.0", kParts, {}, true, 50, "skirt not tracked"},
      {"no_temporal", "temporal terms", kParts, {"temporal", "velocity", "acceleration"}},
      {"no_fixed_lag", "poses smoothed over five frames", kParts, {"fixed_lag"}},
      {"no_mask_gating", "learned-mask gating", kParts, {"mask_gating"}},
      {"no_confidence", "confidence weights", kParts, {"confidence"}},
  };
  return list;
}

std::string options_text(const Variant& variant) {
  std::string text;
  const auto add = [&](const std::string& option) { text += (text.empty() ? "" : " ") + option; };
  if (!variant.surface) add("--no-surface");
  std::string names;
  for (const std::string& name : variant.without) names += (names.empty() ? "" : ",") + name;
  if (!names.empty()) add("--without " + names);
  if (variant.rigidity > 0) add("--rigidity " + std::to_string(static_cast<int>(variant.rigidity)));
  return text;
}

// The network's own joints as a row: only the joint errors mean anything.
AblationRow network_row(const EvalReport& full) {
  AblationRow row{"network only: re-boned 3D placed by 2D", kBaseline, "", "", {}};
  row.report.n_person = full.n_person;
  for (const FrameEval& frame : full.frames) {
    row.report.n_lost += std::isfinite(frame.joint_mm) && !std::isfinite(frame.network_aligned_mm);
  }
  row.report.joint_mm = full.network_joint_mm;
  row.report.joint_aligned_mm = full.network_joint_aligned_mm;
  return row;
}

}  // namespace

std::filesystem::path full_capture_folder(const CaptureOptions& capture) {
  return std::filesystem::path(capture.out) / kFullFolder;
}

Ablation run_ablation(const CaptureOptions& capture, const EvalOptions& eval) {
  capture.validate();
  open_truth(eval.truth, 0);  // complain before anything is captured
  catch_interrupt();
  Progress progress("eval");
  Ablation ablation;
  ablation.video = capture.video;
  const int64_t n_runs = static_cast<int64_t>(variants().size());
  int64_t done = 0;
  for (const Variant& variant : variants()) {
    CaptureOptions options = capture;
    options.out = (std::filesystem::path(capture.out) / variant.folder).string();
    options.surface = variant.surface;
    options.rigidity = variant.rigidity;
    options.without.insert(options.without.end(), variant.without.begin(), variant.without.end());
    run_capture(options, [](const FrameReport&, int64_t) { return !interrupted(); });
    if (interrupted())
      throw Error("interrupted after " + std::to_string(done) + " of " + std::to_string(n_runs) + " runs");
    EvalOptions against = eval;
    against.capture = options.out;
    if (variant.folder == kFullFolder) ablation.full = ablation.rows.size();
    if (!variant.surface && variant.without.empty()) ablation.pose_only = ablation.rows.size();
    ablation.rows.push_back({variant.name, variant.group, options_text(variant), variant.paper, evaluate(against)});
    progress.update(++done, n_runs, variant.name);
  }
  progress.finish();
  ablation.rows.insert(ablation.rows.begin(), network_row(ablation.rows[ablation.full].report));
  ++ablation.full;
  ++ablation.pose_only;
  return ablation;
}

}  // namespace livecap::tools
