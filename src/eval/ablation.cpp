#include "eval/ablation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/html_text.h"
#include "base/json_text.h"
#include "base/text.h"

namespace livecap {
namespace {

using Json = nlohmann::ordered_json;

std::string number(double value, int digits, const char* unknown) {
  return std::isfinite(value) ? format("%.*f", digits, value) : unknown;
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

// Mean of a sample of at least one value, and its standard deviation; the latter is NaN of one value.
DrawnError spread_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  if (values.size() < 2) return {mean, std::numeric_limits<double>::quiet_NaN()};
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return {mean, std::sqrt(sum / (n - 1))};
}

double mean_of(const std::vector<EvalReport>& draws, const std::function<double(const EvalReport&)>& figure) {
  double sum = 0;
  for (const EvalReport& report : draws) sum += figure(report);
  return sum / static_cast<double>(draws.size());
}

// The figures of a row, as all three forms of the table show them. NaN: it has none.
struct RowFigures {
  double iou, worst_iou, vertex_mm, deviation_mm;
  VertexChange change;
  double loose_mm, head_mm, joint_mm, vertex_jitter, joint_jitter;
  int64_t n_lost;
};

RowFigures figures_of(const AblationRow& row, const AblationRow& full) {
  RowFigures f{};
  f.iou = mean_of(row.draws, [](const EvalReport& r) { return mean_or_nan(r.iou); });
  f.worst_iou = std::numeric_limits<double>::quiet_NaN();
  for (const EvalReport& report : row.draws) {
    if (report.iou.n > 0) f.worst_iou = std::fmin(f.worst_iou, report.iou.min);
    f.n_lost += report.n_lost;
  }
  const DrawnError vertices = vertex_error(row);
  f.vertex_mm = vertices.mean_mm;
  f.deviation_mm = vertices.deviation_mm;
  f.change = vertex_change(row, full);
  f.loose_mm = mean_of(row.draws, [](const EvalReport& r) { return mean_or_nan(r.loose_aligned_mm); });
  f.head_mm = mean_of(row.draws, head_mm);
  f.joint_mm = mean_of(row.draws, [](const EvalReport& r) { return mean_or_nan(r.joint_aligned_mm); });
  f.vertex_jitter = mean_of(row.draws, [](const EvalReport& r) { return error_over_truth(r.vertex_jitter); });
  f.joint_jitter = mean_of(row.draws, [](const EvalReport& r) { return error_over_truth(r.joint_jitter); });
  return f;
}

std::string change_text(const VertexChange& change, const char* unknown, const char* plus_minus) {
  if (!std::isfinite(change.change)) return unknown;
  std::string text = format("%+.1f %%", 100 * change.change);
  if (std::isfinite(change.standard_error)) text += format(" %s %.1f", plus_minus, 100 * change.standard_error);
  return text;
}

// Whether a row has several draws; the table has a column for how far they are apart.
bool is_drawn(const Ablation& ablation) {
  return std::any_of(ablation.rows.begin(), ablation.rows.end(), [](const auto& row) { return row.draws.size() > 1; });
}

}  // namespace

VertexChange vertex_change(const AblationRow& row, const AblationRow& full) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const double of_full = vertex_error(full).mean_mm;
  if (!(of_full > 0)) return {kUnknown, kUnknown};
  const double change = vertex_error(row).mean_mm / of_full - 1;
  if (row.draws.size() != full.draws.size()) return {change, kUnknown};
  std::vector<double> differences;
  for (size_t i = 0; i < row.draws.size(); ++i)
    differences.push_back(mean_or_nan(row.draws[i].vertex_aligned_mm) - mean_or_nan(full.draws[i].vertex_aligned_mm));
  const auto n = static_cast<double>(differences.size());
  return {change, spread_of(differences).deviation_mm / std::sqrt(n) / of_full};
}

DrawnError vertex_error(const AblationRow& row) {
  std::vector<double> errors;
  for (const EvalReport& report : row.draws) errors.push_back(mean_or_nan(report.vertex_aligned_mm));
  return spread_of(errors);
}

std::string ablation_text(const Ablation& ablation) {
  const AblationRow& full = ablation.rows[ablation.full];
  const bool drawn = is_drawn(ablation);
  const auto apart = [&](const std::string& text) { return drawn ? format(" %6s", text.c_str()) : std::string(); };
  const int change_width = drawn ? 15 : 8;
  std::string text =
      format("%-45s %6s %6s %8s%s %*s %8s %8s %8s %7s %5s  %s\n", "", "IoU", "worst", "vertex", apart("+-").c_str(),
             change_width, "change", "loose", "head", "joints", "jitter", "lost", "the paper");
  std::string group;
  for (const AblationRow& row : ablation.rows) {
    if (row.group != group) text += (group = row.group) + "\n";
    const RowFigures f = figures_of(row, full);
    text += format("  %-43s %6s %6s %8s%s %*s %8s %8s %8s %7s %5lld  %s\n", row.name.c_str(),
                   number(f.iou, 3, "-").c_str(), number(f.worst_iou, 3, "-").c_str(),
                   number(f.vertex_mm, 1, "-").c_str(), apart(number(f.deviation_mm, 1, "-")).c_str(), change_width,
                   change_text(f.change, "-", "+-").c_str(), number(f.loose_mm, 1, "-").c_str(),
                   number(f.head_mm, 1, "-").c_str(), number(f.joint_mm, 1, "-").c_str(),
                   number(f.vertex_jitter, 2, "-").c_str(), static_cast<long long>(f.n_lost), row.paper.c_str());
  }
  return text;
}

std::string ablation_json(const Ablation& ablation) {
  const AblationRow& full = ablation.rows[ablation.full];
  const auto value = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  Json rows = Json::array();
  for (const AblationRow& row : ablation.rows) {
    const RowFigures f = figures_of(row, full);
    rows.push_back({{"name", row.name},
                    {"group", row.group},
                    {"options", row.options},
                    {"paper", row.paper},
                    {"draws", row.draws.size()},
                    {"iou_mean", value(f.iou)},
                    {"iou_worst", value(f.worst_iou)},
                    {"vertex_translation_aligned_mm", value(f.vertex_mm)},
                    {"vertex_standard_deviation_of_draws_mm", value(f.deviation_mm)},
                    {"change_of_vertex_error", value(f.change.change)},
                    {"standard_error_of_change", value(f.change.standard_error)},
                    {"loose_translation_aligned_mm", value(f.loose_mm)},
                    {"head_translation_aligned_mm", value(f.head_mm)},
                    {"joint_similarity_aligned_mm", value(f.joint_mm)},
                    {"vertex_jitter_ratio", value(f.vertex_jitter)},
                    {"joint_jitter_ratio", value(f.joint_jitter)},
                    {"frames_lost", f.n_lost}});
  }
  return json_text(Json{{"video", ablation.video}, {"rows", rows}}, 2);
}

std::string ablation_html(const Ablation& ablation) {
  const AblationRow& full = ablation.rows[ablation.full];
  const bool drawn = is_drawn(ablation);
  std::string html = std::string("<table class=\"numbers\"><tr><th>run</th><th>IoU</th><th>worst</th>") +
                     "<th>vertices, mm</th>" + (drawn ? "<th>&plusmn;</th>" : "") +
                     "<th>change</th><th>loose, mm</th><th>head, mm</th><th>joints, mm</th><th>jitter / truth</th>"
                     "<th>lost</th><th>the paper</th></tr>\n";
  std::string group;
  for (size_t i = 0; i < ablation.rows.size(); ++i) {
    const AblationRow& row = ablation.rows[i];
    if (row.group != group) {
      group = row.group;
      html += format("<tr class=\"group\"><td colspan=\"%d\">", drawn ? 12 : 11) + html_escaped(group) + "</td></tr>\n";
    }
    const RowFigures f = figures_of(row, full);
    const double change = f.change.change;
    const char* kind = !std::isfinite(change) || std::abs(change) < 0.0005 ? "" : change > 0 ? "worse" : "better";
    html += std::string("<tr") + (i == ablation.full ? " class=\"full\"" : "") + "><td title=\"" +
            html_escaped(row.options) + "\">" + html_escaped(row.name) + "</td>";
    std::vector<std::string> cells = {number(f.iou, 3, "&ndash;"), number(f.worst_iou, 3, "&ndash;"),
                                      number(f.vertex_mm, 1, "&ndash;")};
    if (drawn) cells.push_back(number(f.deviation_mm, 1, "&ndash;"));
    cells.push_back(std::string("<span class=\"") + kind + "\">" + change_text(f.change, "&ndash;", "&plusmn;") +
                    "</span>");
    for (const double mm : {f.loose_mm, f.head_mm, f.joint_mm}) cells.push_back(number(mm, 1, "&ndash;"));
    cells.push_back(number(f.vertex_jitter, 2, "&ndash;"));
    cells.push_back(format("%lld", static_cast<long long>(f.n_lost)));
    cells.push_back(html_escaped(row.paper));
    for (const std::string& cell : cells) html += "<td>" + cell + "</td>";
    html += "</tr>\n";
  }
  return html + "</table>";
}

}  // namespace livecap
