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
  bool learn = true;  // of the first frames beforehand
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
      {"no_surface_match", "matching of hanging cloth", kParts, {"surface_match"}},
      {"no_cloth_behind", "cloth behind moved as that before it", kParts, {"cloth_behind"}},
      {"no_cloth_anew", "cloth matched from its simulation as well", kParts, {"cloth_anew"}},
      {"no_drape", "drape of cloth learned", kParts, {"drape"}},
      {"no_match", "texture matching", kParts, {"match"}},
      {"no_shading", "skin shading", kParts, {"shading"}},
      {"no_floor", "floor under the feet", kParts, {"floor"}},
      {"no_upright", "upright edges of the room", kParts, {"upright"}},
      {"no_learning", "first frames looked at beforehand", kParts, {}, true, 0, "", false},
      {"no_balance", "feet below the centre of mass", kParts, {"balance"}},
      {"no_hidden_arms", "arms that hide held, and found again", kParts, {"hidden_arms"}},
      {"no_rest", "chest, collarbones and feet drawn to rest", kParts, {"rest"}},
      {"no_depth", "surface held along the line of sight", kParts, {"depth"}},
      {"rigidity_2", "material weights: constant 2.0", kParts, {}, true, 2, "head distorted"},
      {"rigidity_50", "material weights: constant 50.0", kParts, {}, true, 50, "skirt not tracked"},
      {"no_temporal", "temporal terms", kParts, {"temporal", "velocity", "acceleration"}},
      {"no_fixed_lag", "poses made steady", kParts, {"fixed_lag"}},
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
  if (!variant.learn) add("--learn-frames 0");
  if (variant.rigidity > 0) add("--rigidity " + std::to_string(static_cast<int>(variant.rigidity)));
  return text;
}

// The network's own joints as a row: only the joint errors mean anything.
AblationRow network_row(const AblationRow& full) {
  AblationRow row{"network only: re-boned 3D placed by 2D", kBaseline, "", "", {}};
  for (const EvalReport& draw : full.draws) {
    EvalReport& report = row.draws.emplace_back();
    report.n_person = draw.n_person;
    for (const FrameEval& frame : draw.frames) {
      report.n_lost += std::isfinite(frame.joint_mm) && !std::isfinite(frame.network_aligned_mm);
    }
    report.joint_mm = draw.network_joint_mm;
    report.joint_aligned_mm = draw.network_joint_aligned_mm;
  }
  return row;
}

std::filesystem::path capture_folder(const CaptureOptions& capture, std::string_view row, int draw) {
  std::string name(row);
  if (draw > 0) name += "_draw" + std::to_string(draw);
  return std::filesystem::path(capture.out) / name;
}

}  // namespace

std::filesystem::path full_capture_folder(const CaptureOptions& capture) {
  return capture_folder(capture, kFullFolder, 0);
}

Ablation run_ablation(const CaptureOptions& capture, const EvalOptions& eval, int draws, bool keep) {
  capture.validate();
  open_truth(eval.truth, 0);  // complain before anything is captured
  catch_interrupt();
  Progress progress("eval");
  Ablation ablation;
  ablation.video = capture.video;
  const int64_t n_runs = static_cast<int64_t>(variants().size()) * draws;
  int64_t done = 0;
  for (const Variant& variant : variants()) {
    if (variant.folder == kFullFolder) ablation.full = ablation.rows.size();
    if (!variant.surface && variant.without.empty()) ablation.pose_only = ablation.rows.size();
    AblationRow& row =
        ablation.rows.emplace_back(AblationRow{variant.name, variant.group, options_text(variant), variant.paper, {}});
    for (int draw = 0; draw < draws; ++draw) {
      CaptureOptions options = capture;
      options.out = capture_folder(capture, variant.folder, draw).string();
      options.draw = draw;
      options.surface = variant.surface;
      if (!variant.learn) options.learn_frames = 0;
      if (variant.rigidity > 0) options.rigidity = variant.rigidity;
      options.without.insert(options.without.end(), variant.without.begin(), variant.without.end());
      run_capture(
          options, [](const FrameReport&, int64_t) { return !interrupted(); },
          [](int64_t, int64_t) { return !interrupted(); });
      if (interrupted())
        throw Error("interrupted after " + std::to_string(done) + " of " + std::to_string(n_runs) + " runs");
      EvalOptions against = eval;
      against.capture = options.out;
      row.draws.push_back(evaluate(against));
      if (!keep && options.out != full_capture_folder(capture)) std::filesystem::remove_all(options.out);
      progress.update(++done, n_runs, variant.name);
    }
  }
  progress.finish();
  ablation.rows.insert(ablation.rows.begin(), network_row(ablation.rows[ablation.full]));
  ++ablation.full;
  ++ablation.pose_only;
  return ablation;
}

}  // namespace livecap::tools
