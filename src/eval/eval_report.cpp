#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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

// Mean, median, the value only 5 % of the samples are worse than, and the worst.
std::string summary_line(const char* name, const Summary& summary, int digits, bool high_is_good) {
  if (summary.n == 0) return format("%-34s no ground truth\n", name);
  std::string line = format("%-34s", name);
  for (double value : {summary.mean, summary.median, high_is_good ? summary.p05 : summary.p95,
                       high_is_good ? summary.min : summary.max}) {
    line += format(" %8.*f", digits, value);
  }
  return line + "\n";
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
  text += format("frames %lld, with a person %lld: tracked %lld, lost %lld, without any result %lld; invented %lld\n",
                 static_cast<long long>(report.n_frames), static_cast<long long>(report.n_person),
                 static_cast<long long>(report.n_tracked), static_cast<long long>(report.n_lost),
                 static_cast<long long>(report.n_without_result), static_cast<long long>(report.n_invented));
  text += format("%-34s %8s %8s %8s %8s\n", "", "mean", "median", "worst 5%", "worst");
  text += summary_line("silhouette IoU", report.iou, 4, true);
  text += summary_line("vertex error, mm", report.vertex_mm, 1, false);
  text += summary_line("  after translation alignment", report.vertex_aligned_mm, 1, false);
  text += summary_line("joint error, mm", report.joint_mm, 1, false);
  text += summary_line("  after similarity alignment", report.joint_aligned_mm, 1, false);
  if (!report.joints_aligned_mm.empty()) {
    text += "joints, mm after alignment        ";
    for (const auto& [name, value] : report.joints_aligned_mm) text += format(" %s %.0f", name.c_str(), value);
    text += "\n";
  }
  text += worst_frames(report, "IoU", 3, -1, [](const FrameEval& frame) { return -frame.iou; });
  text +=
      worst_frames(report, "vertex error, mm", 0, 1, [](const FrameEval& frame) { return frame.vertex_aligned_mm; });
  text += worst_frames(report, "joint error, mm", 0, 1, [](const FrameEval& frame) { return frame.joint_aligned_mm; });
  return text;
}

std::string eval_report_json(const EvalReport& report) {
  Json json = {{"frames_total", report.n_frames},
               {"frames_with_person", report.n_person},
               {"frames_tracked", report.n_tracked},
               {"frames_lost", report.n_lost},
               {"frames_without_result", report.n_without_result},
               {"frames_invented", report.n_invented},
               {"iou", summary_json(report.iou)},
               {"vertex_mm", summary_json(report.vertex_mm)},
               {"vertex_translation_aligned_mm", summary_json(report.vertex_aligned_mm)},
               {"joint_mm", summary_json(report.joint_mm)},
               {"joint_similarity_aligned_mm", summary_json(report.joint_aligned_mm)}};
  for (const auto& [name, value] : report.joints_aligned_mm) json["joints_aligned_mm"][name] = number(value);
  json["frames"] = Json::array();
  for (const FrameEval& frame : report.frames) {
    json["frames"].push_back({{"index", frame.index},
                              {"status", frame.status},
                              {"iou", number(frame.iou)},
                              {"vertex_mm", number(frame.vertex_mm)},
                              {"vertex_translation_aligned_mm", number(frame.vertex_aligned_mm)},
                              {"joint_mm", number(frame.joint_mm)},
                              {"joint_similarity_aligned_mm", number(frame.joint_aligned_mm)}});
  }
  return json.dump(2) + "\n";
}

}  // namespace livecap
