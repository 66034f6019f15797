#include "eval/ablation.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/html_text.h"
#include "base/text.h"

namespace livecap {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value, int digits, const char* unknown) {
  return std::isfinite(value) ? format("%.*f", digits, value) : unknown;
}

double mean(const Summary& summary) {
  return summary.n > 0 ? summary.mean : std::numeric_limits<double>::quiet_NaN();
}

double jitter(const Jitter& jitter) {
  return jitter.n > 0 && jitter.truth > 0 ? jitter.error / jitter.truth : std::numeric_limits<double>::quiet_NaN();
}

double worst_iou(const EvalReport& report) {
  return report.iou.n > 0 ? report.iou.min : std::numeric_limits<double>::quiet_NaN();
}

// Face and hair, translation-aligned: what too soft a surface distorts.
double head_mm(const EvalReport& report) {
  double sum = 0;
  int64_t n = 0;
  for (const LabelError& label : report.labels) {
    if (label.label != "face" && label.label != "hair") continue;
    sum += label.aligned.mean * static_cast<double>(label.aligned.n);
    n += label.aligned.n;
  }
  return n > 0 ? sum / static_cast<double>(n) : std::numeric_limits<double>::quiet_NaN();
}

std::string change_text(double change, const char* unknown) {
  return std::isfinite(change) ? format("%+.1f %%", 100 * change) : unknown;
}

}  // namespace

double relative_change(const Summary& row, const Summary& full) {
  if (row.n == 0 || full.n == 0 || !(full.mean > 0)) return std::numeric_limits<double>::quiet_NaN();
  return row.mean / full.mean - 1;
}

std::string ablation_text(const Ablation& ablation) {
  const EvalReport& full = ablation.rows[ablation.full].report;
  std::string text = format("%-45s %6s %6s %8s %8s %8s %8s %8s %7s %5s  %s\n", "", "IoU", "worst", "vertex", "change",
                            "loose", "head", "joints", "jitter", "lost", "the paper");
  std::string group;
  for (const AblationRow& row : ablation.rows) {
    if (row.group != group) text += (group = row.group) + "\n";
    const EvalReport& report = row.report;
    text += format("  %-43s %6s %6s %8s %8s %8s %8s %8s %7s %5lld  %s\n", row.name.c_str(),
                   number(mean(report.iou), 3, "-").c_str(), number(worst_iou(report), 3, "-").c_str(),
                   number(mean(report.vertex_aligned_mm), 1, "-").c_str(),
                   change_text(relative_change(report.vertex_aligned_mm, full.vertex_aligned_mm), "-").c_str(),
                   number(mean(report.loose_aligned_mm), 1, "-").c_str(), number(head_mm(report), 1, "-").c_str(),
                   number(mean(report.joint_aligned_mm), 1, "-").c_str(),
                   number(jitter(report.vertex_jitter), 2, "-").c_str(), static_cast<long long>(report.n_lost),
                   row.paper.c_str());
  }
  return text;
}

std::string ablation_json(const Ablation& ablation) {
  const EvalReport& full = ablation.rows[ablation.full].report;
  const auto value = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  Json rows = Json::array();
  for (const AblationRow& row : ablation.rows) {
    const EvalReport& report = row.report;
    rows.push_back(
        {{"name", row.name},
         {"group", row.group},
         {"options", row.options},
         {"paper", row.paper},
         {"iou_mean", value(mean(report.iou))},
         {"iou_worst", value(worst_iou(report))},
         {"vertex_translation_aligned_mm", value(mean(report.vertex_aligned_mm))},
         {"change_of_vertex_error", value(relative_change(report.vertex_aligned_mm, full.vertex_aligned_mm))},
         {"loose_translation_aligned_mm", value(mean(report.loose_aligned_mm))},
         {"head_translation_aligned_mm", value(head_mm(report))},
         {"joint_similarity_aligned_mm", value(mean(report.joint_aligned_mm))},
         {"vertex_jitter_ratio", value(jitter(report.vertex_jitter))},
         {"joint_jitter_ratio", value(jitter(report.joint_jitter))},
         {"frames_lost", report.n_lost}});
  }
  return Json{{"video", ablation.video}, {"rows", rows}}.dump(2);
}

std::string ablation_html(const Ablation& ablation) {
  const EvalReport& full = ablation.rows[ablation.full].report;
  std::string html =
      "<table class=\"numbers\"><tr><th>run</th><th>IoU</th><th>worst</th><th>vertices, mm</th><th>change</th>"
      "<th>loose, mm</th><th>head, mm</th><th>joints, mm</th><th>jitter / truth</th><th>lost</th><th>the "
      "paper</th></tr>\n";
  std::string group;
  for (size_t i = 0; i < ablation.rows.size(); ++i) {
    const AblationRow& row = ablation.rows[i];
    const EvalReport& report = row.report;
    if (row.group != group) {
      group = row.group;
      html += "<tr class=\"group\"><td colspan=\"11\">" + html_escaped(group) + "</td></tr>\n";
    }
    const double change = relative_change(report.vertex_aligned_mm, full.vertex_aligned_mm);
    const char* kind = !std::isfinite(change) || std::abs(change) < 0.0005 ? "" : change > 0 ? "worse" : "better";
    html += std::string("<tr") + (i == ablation.full ? " class=\"full\"" : "") + "><td title=\"" +
            html_escaped(row.options) + "\">" + html_escaped(row.name) + "</td>";
    for (const std::string& cell :
         {number(mean(report.iou), 3, "&ndash;"), number(worst_iou(report), 3, "&ndash;"),
          number(mean(report.vertex_aligned_mm), 1, "&ndash;"),
          std::string("<span class=\"") + kind + "\">" + change_text(change, "&ndash;") + "</span>",
          number(mean(report.loose_aligned_mm), 1, "&ndash;"), number(head_mm(report), 1, "&ndash;"),
          number(mean(report.joint_aligned_mm), 1, "&ndash;"), number(jitter(report.vertex_jitter), 2, "&ndash;"),
          format("%lld", static_cast<long long>(report.n_lost)), html_escaped(row.paper)}) {
      html += "<td>" + cell + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</table>";
}

}  // namespace livecap
