#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/text.h"
#include "eval/evaluate.h"

namespace livecap {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kWorstFrames = 5;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json summary_json(const Summary& summary) {
  if (summary.n == 0) return nullptr;
  return {
      {"n", summary.n}, {"mean", summary.mean}, {"median", summary.median}, {"p95", summary.p95}, {"max", summary.max}};
}

// "-" of what is not known.
std::string figure(double value, int digits) {
  return std::isfinite(value) ? format("%.*f", digits, value) : "-";
}

// Mean, median, the value only 5 % of the samples are worse than, and the worst.
std::string summary_line(const char* name, const Summary& summary, int digits, bool high_is_good) {
  if (summary.n == 0) return format("%-34s nothing to compare\n", name);
  std::string line = format("%-34s", name);
  for (double value : {summary.mean, summary.median, high_is_good ? summary.p05 : summary.p95,
                       high_is_good ? summary.min : summary.max}) {
    line += format(" %8.*f", digits, value);
  }
  return line + "\n";
}

std::string jitter_line(const char* name, const Jitter& jitter) {
  if (jitter.n == 0) return {};
  return format("%-34s %8.2f %8.2f %8.2f %8s\n", name, jitter.error, jitter.captured, jitter.truth,
                figure(error_over_truth(jitter), 2).c_str());
}

Json jitter_json(const Jitter& jitter) {
  if (jitter.n == 0) return nullptr;
  return {{"n", jitter.n}, {"error", jitter.error}, {"captured", jitter.captured}, {"truth", jitter.truth}};
}

Json pck_json(const PckScore& score) {
  return {{"pck_150mm", number(score.pck)}, {"auc_150mm", number(score.auc)}};
}

std::string motion_text(const EvalReport& report) {
  std::string text;
  if (report.vertex_jitter.n + report.joint_jitter.n > 0) {
    text += format("%-34s %8s %8s %8s %8s\n", "acceleration, m/s^2", "error", "captured", "truth", "err/true");
    text += jitter_line("vertices", report.vertex_jitter);
    text += jitter_line("  relative to their centroid", report.vertex_jitter_centred);
    text += jitter_line("joints", report.joint_jitter);
  }
  if (report.foot_slide.n > 0) {
    text += format("foot slide, mm/s                   %8.1f (the truth's own %.1f, %lld steps)\n",
                   report.foot_slide.mm_per_s, report.foot_slide.truth_mm_per_s,
                   static_cast<long long>(report.foot_slide.n));
  }
  if (std::isfinite(report.at_limit)) {
    text += format("joint angles at a limit            %8.1f %%\n", 100 * report.at_limit);
  }
  if (report.joint_mm.n > 0) {
    text += format("left and right exchanged           %8lld frames of arms, %lld of legs; an arm in the trunk: %lld\n",
                   static_cast<long long>(report.n_arms_exchanged), static_cast<long long>(report.n_legs_exchanged),
                   static_cast<long long>(report.n_limb_inside));
  }
  const Losses& losses = report.losses;
  text += format("losses                             %8lld, recovered %lld, longest %lld frames, entry %lld frames\n",
                 static_cast<long long>(losses.n_losses), static_cast<long long>(losses.n_recovered),
                 static_cast<long long>(losses.longest), static_cast<long long>(losses.longest_entry));
  if (std::isfinite(report.speed.latency_ms)) {
    text +=
        format("latency, ms                        %8.0f median, %s worst 5%%, at %s fps\n", report.speed.latency_ms,
               figure(report.speed.latency_p95_ms, 0).c_str(), figure(report.speed.fps, 1).c_str());
  }
  return text;
}

// The frames with the largest badness; NaN left out. sign * badness is what is printed.
template <typename Badness>
std::string worst_frames(const EvalReport& report, const char* name, int digits, double sign, Badness&& badness) {
  std::vector<const FrameEval*> frames;
  for (const FrameEval& frame : report.frames) {
    if (std::isfinite(badness(frame))) frames.push_back(&frame);
  }
  if (frames.empty()) return {};
  const size_t n = std::min(kWorstFrames, frames.size());
  std::partial_sort(frames.begin(), frames.begin() + n, frames.end(),
                    [&](const FrameEval* a, const FrameEval* b) { return badness(*a) > badness(*b); });
  std::string line = format("worst frames by %-18s", name);
  for (size_t i = 0; i < n; ++i) {
    line += format(" %lld (%.*f%s%s)", static_cast<long long>(frames[i]->index), digits, sign * badness(*frames[i]),
                   frames[i]->tracked ? "" : ", ", frames[i]->tracked ? "" : frames[i]->status.c_str());
  }
  return line + "\n";
}

}  // namespace

std::string eval_report_text(const EvalReport& report) {
  std::string text;
  text += format(
      "frames %lld, with a person %lld of %lld in the truth%s: tracked %lld, lost %lld, without any result %lld; "
      "invented %lld\n",
      static_cast<long long>(report.n_frames), static_cast<long long>(report.n_person),
      static_cast<long long>(report.n_true_person), report.n_not_asked > 0 ? " (capture --first, --frames)" : "",
      static_cast<long long>(report.n_tracked), static_cast<long long>(report.n_lost),
      static_cast<long long>(report.n_without_result), static_cast<long long>(report.n_invented));
  text += format("%-34s %8s %8s %8s %8s\n", "", "mean", "median", "worst 5%", "worst");
  text += summary_line("silhouette IoU", report.iou, 4, true);
  for (const ViewScore& view : report.views) {
    text += summary_line(("  in " + view.name).c_str(), view.iou, 4, true);
  }
  text += summary_line("vertex error, mm", report.vertex_mm, 1, false);
  text += summary_line("  after translation alignment", report.vertex_aligned_mm, 1, false);
  for (const LabelError& row : report.labels) {
    text += summary_line(format("    %s (%d)", row.label.c_str(), row.n_vertices).c_str(), row.aligned, 1, false);
  }
  if (report.other_mesh && report.true_vertex_aligned_mm.n > 0)
    text += summary_line("  at the truth's vertices, aligned", report.true_vertex_aligned_mm, 1, false);
  if (report.surface_mm.n > 0) {
    text += summary_line("  to the true surface", report.surface_mm, 1, false);
    if (report.other_mesh) text += "  (another mesh than the truth's: true vertices by nearest points at rest)\n";
  }
  if (report.loose_aligned_mm.n > 0) {
    text += summary_line("    loose garments together", report.loose_aligned_mm, 1, false);
  }
  text += summary_line("joint error, mm", report.joint_mm, 1, false);
  text += summary_line("  after similarity alignment", report.joint_aligned_mm, 1, false);
  if (report.other_mesh && report.body_point_mm.n > 0) {
    text += summary_line("  the same points of the body", report.body_point_mm, 1, false);
    text += summary_line("    after similarity alignment", report.body_point_aligned_mm, 1, false);
  }
  if (report.network_joint_aligned_mm.n > 0) {
    text += summary_line("  the network's own, aligned", report.network_joint_aligned_mm, 1, false);
  }
  if (std::isfinite(report.pck_similarity.pck)) {
    text += format("3DPCK at 150 mm / AUC              %8.3f / %.3f similarity-aligned", report.pck_similarity.pck,
                   report.pck_similarity.auc);
    if (std::isfinite(report.pck_root.pck))
      text += format(", %.3f / %.3f root-aligned", report.pck_root.pck, report.pck_root.auc);
    text += "\n";
  }
  const auto each = [&](const char* what, const std::vector<std::pair<std::string, double>>& values) {
    if (values.empty()) return;
    text += format("%-34s", what);
    for (const auto& [name, value] : values) text += " " + name + " " + figure(value, 0);
    text += "\n";
  };
  each("joints, mm after alignment", report.joints_aligned_mm);
  if (report.other_mesh && report.body_point_mm.n > 0)
    each("  the same points of the body", report.body_points_aligned_mm);
  text += motion_text(report);
  text += worst_frames(report, "IoU", 3, -1, [](const FrameEval& frame) { return -frame.iou; });
  text +=
      worst_frames(report, "vertex error, mm", 0, 1, [](const FrameEval& frame) { return frame.vertex_aligned_mm; });
  text += worst_frames(report, "joint error, mm", 0, 1, [](const FrameEval& frame) { return frame.joint_aligned_mm; });
  return text;
}

std::string eval_report_json(const EvalReport& report) {
  Json json = {
      {"frames_total", report.n_frames},
      {"frames_with_person", report.n_person},
      {"frames_with_person_in_truth", report.n_true_person},
      {"frames_tracked", report.n_tracked},
      {"frames_lost", report.n_lost},
      {"frames_without_result", report.n_without_result},
      {"frames_invented", report.n_invented},
      {"losses", report.losses.n_losses},
      {"losses_recovered", report.losses.n_recovered},
      {"longest_loss_frames", report.losses.longest},
      {"longest_entry_frames", report.losses.longest_entry},
      {"iou", summary_json(report.iou)},
      {"vertex_mm", summary_json(report.vertex_mm)},
      {"vertex_translation_aligned_mm", summary_json(report.vertex_aligned_mm)},
      {"true_vertex_translation_aligned_mm", summary_json(report.true_vertex_aligned_mm)},
      {"other_mesh", report.other_mesh},
      {"surface_mm", summary_json(report.surface_mm)},
      {"loose_mm", summary_json(report.loose_mm)},
      {"loose_translation_aligned_mm", summary_json(report.loose_aligned_mm)},
      {"joint_mm", summary_json(report.joint_mm)},
      {"joint_similarity_aligned_mm", summary_json(report.joint_aligned_mm)},
      {"body_point_mm", summary_json(report.body_point_mm)},
      {"body_point_similarity_aligned_mm", summary_json(report.body_point_aligned_mm)},
      {"joint_pck_similarity_aligned", pck_json(report.pck_similarity)},
      {"joint_pck_root_aligned", pck_json(report.pck_root)},
      {"network_joint_mm", summary_json(report.network_joint_mm)},
      {"network_joint_similarity_aligned_mm", summary_json(report.network_joint_aligned_mm)},
      {"video_fps", number(report.video_fps)},
      {"vertex_acceleration_m_s2", jitter_json(report.vertex_jitter)},
      {"vertex_centred_acceleration_m_s2", jitter_json(report.vertex_jitter_centred)},
      {"joint_acceleration_m_s2", jitter_json(report.joint_jitter)},
      {"foot_slide_mm_s", report.foot_slide.n > 0 ? number(report.foot_slide.mm_per_s) : Json(nullptr)},
      {"foot_slide_truth_mm_s", report.foot_slide.n > 0 ? number(report.foot_slide.truth_mm_per_s) : Json(nullptr)},
      {"frames_arms_exchanged", report.n_arms_exchanged},
      {"frames_legs_exchanged", report.n_legs_exchanged},
      {"frames_arm_inside_trunk", report.n_limb_inside},
      {"angles_at_limit", number(report.at_limit)},
      {"fps", number(report.speed.fps)},
      {"latency_ms", number(report.speed.latency_ms)},
      {"latency_p95_ms", number(report.speed.latency_p95_ms)}};
  for (const ViewScore& view : report.views) json["views"][view.name] = summary_json(view.iou);
  for (const LabelError& row : report.labels) {
    json["labels"][row.label] = {{"vertices", row.n_vertices},
                                 {"vertex_mm", summary_json(row.direct)},
                                 {"vertex_translation_aligned_mm", summary_json(row.aligned)}};
  }
  for (const auto& [name, value] : report.joints_aligned_mm) json["joints_aligned_mm"][name] = number(value);
  for (const auto& [name, value] : report.body_points_aligned_mm) json["body_points_aligned_mm"][name] = number(value);
  for (const auto& [name, value] : report.angles_at_limit) json["angle_at_limit"][name] = number(value);
  json["frames"] = Json::array();
  for (const FrameEval& frame : report.frames) {
    json["frames"].push_back({{"index", frame.index},
                              {"status", frame.status},
                              {"iou", number(frame.iou)},
                              {"vertex_mm", number(frame.vertex_mm)},
                              {"vertex_translation_aligned_mm", number(frame.vertex_aligned_mm)},
                              {"loose_translation_aligned_mm", number(frame.loose_aligned_mm)},
                              {"joint_mm", number(frame.joint_mm)},
                              {"joint_similarity_aligned_mm", number(frame.joint_aligned_mm)},
                              {"network_joint_similarity_aligned_mm", number(frame.network_aligned_mm)},
                              {"arms_exchanged", frame.arms_exchanged},
                              {"legs_exchanged", frame.legs_exchanged},
                              {"arm_inside_trunk", frame.limb_inside}});
  }
  return json_text(json, 2) + "\n";
}

}  // namespace livecap
