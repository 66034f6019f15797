#include "eval/bars.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/text.h"

namespace livecap {
namespace {

double ratio(double a, double b) {
  return b > 0 ? a / b : kNaN;
}

}  // namespace

bool Bar::known() const {
  return std::isfinite(value);
}

bool Bar::passed() const {
  return known() && (at_least ? value >= bar : value <= bar);
}

std::vector<Bar> judge_bars(const EvalReport& report, const EvalReport* pose_only) {
  const double vertex = mean_or_nan(report.vertex_aligned_mm);
  const double loose = mean_or_nan(report.loose_aligned_mm);
  const double joint = mean_or_nan(report.joint_aligned_mm);
  const double pose_vertex = pose_only ? mean_or_nan(pose_only->vertex_aligned_mm) : kNaN;
  const double pose_loose = pose_only ? mean_or_nan(pose_only->loose_aligned_mm) : kNaN;
  const bool has_joints = report.joint_mm.n > 0;
  std::vector<Bar> bars = {
      {"silhouette IoU, mean", true, 0.95, mean_or_nan(report.iou), 3, ""},
      {"silhouette IoU, worst frame", true, 0.88, report.iou.n > 0 ? report.iou.min : kNaN, 3, ""},
      {"vertex error, translation-aligned, mean", false, 20, vertex, 1, " mm"},
      {"  against pose only", false, 0.85, ratio(vertex, pose_vertex), 2, " x"},
      {"  loose garments against pose only", false, 0.70, ratio(loose, pose_loose), 2, " x"},
      {"joint error, similarity-aligned, mean", false, 35, joint, 1, " mm"},
      {"  against the network's own joints", false, 0.75, ratio(joint, mean_or_nan(report.network_joint_aligned_mm)), 2,
       " x"},
      {"frames lost", false, 0, static_cast<double>(report.n_lost), 0, ""},
      {"frames with left and right exchanged", false, 0,
       has_joints ? static_cast<double>(report.n_arms_exchanged + report.n_legs_exchanged) : kNaN, 0, ""},
      {"frames with an arm pulled into the trunk", false, 0,
       has_joints ? static_cast<double>(report.n_limb_inside) : kNaN, 0, ""},
      {"jitter of vertices against the truth's acceleration", false, 1.3, error_over_truth(report.vertex_jitter), 2,
       " x"},
      {"jitter of joints against the truth's acceleration", false, 1.3, error_over_truth(report.joint_jitter), 2, " x"},
  };
  return bars;
}

std::string bar_value_text(const Bar& bar) {
  return bar.known() ? format("%.*f%s", bar.digits, bar.value, bar.unit.c_str()) : "unknown";
}

std::string bar_text(const Bar& bar) {
  if (!bar.at_least && bar.bar == 0) return "none";
  return format("%s %g%s", bar.at_least ? "at least" : "at most", bar.bar, bar.unit.c_str());
}

std::string bars_text(const std::vector<Bar>& bars) {
  std::string text;
  for (const Bar& bar : bars) {
    text += format("%-8s %-52s %10s   (%s)\n",
                   !bar.known()   ? "unknown"
                   : bar.passed() ? "met"
                                  : "MISSED",
                   bar.figure.c_str(), bar_value_text(bar).c_str(), bar_text(bar).c_str());
  }
  return text;
}

std::string bars_json(const std::vector<Bar>& bars) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Bar& bar : bars) {
    const std::string figure = bar.figure.substr(bar.figure.find_first_not_of(' '));
    json.push_back({{"figure", figure},
                    {bar.at_least ? "at_least" : "at_most", bar.bar},
                    {"value", bar.known() ? nlohmann::ordered_json(bar.value) : nlohmann::ordered_json(nullptr)},
                    {"passed", bar.known() ? nlohmann::ordered_json(bar.passed()) : nlohmann::ordered_json(nullptr)}});
  }
  return json_text(json, 2);
}

}  // namespace livecap
