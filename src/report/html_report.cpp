#include "report/html_report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <set>

#include "base/html_text.h"
#include "base/text.h"
#include "image/image_io.h"
#include "picture/turnaround.h"
#include "report/contact_sheet.h"
#include "report/html_style.h"
#include "report/svg_chart.h"

namespace livecap {
namespace {

constexpr size_t kWorstFrames = 5;
constexpr int64_t kWorstApart = 5;  // frames between them, so that one bad moment does not fill the list
constexpr size_t kEvenFrames = 6;
constexpr int kSheetHeight = 300, kMeshHeight = 520;
constexpr double kImprovementMm = 40;  // full colour of the improvement

constexpr const char* kApartNote = "At least five frames apart.";

using Frames = std::vector<const FrameEval*>;

std::string number(double value, int digits) {
  return std::isfinite(value) ? format("%.*f", digits, value) : "&ndash;";
}

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += std::string("<") + tag + ">" + cell + "</" + tag + ">";
  return html + "</tr>\n";
}

std::string section(const std::string& title, const std::string& note, const std::string& body) {
  if (body.empty()) return {};
  return "<section><h2>" + title + "</h2>" + (note.empty() ? "" : "<p class=\"note\">" + note + "</p>") + body +
         "</section>\n";
}

std::string bars_table(const std::vector<Bar>& bars) {
  std::string html = "<table class=\"bars\">" + row({"", "figure", "measured", "bar"}, "th");
  for (const Bar& bar : bars) {
    const char* kind = !bar.known() ? "unknown" : bar.passed() ? "met" : "missed";
    const bool indented = bar.figure[0] == ' ';
    html += "<tr class=\"" + std::string(kind) + "\"><td><span class=\"mark\">" + kind + "</span></td><td" +
            (indented ? " class=\"indented\"" : "") + ">" + html_escaped(bar.figure) + "</td><td class=\"number\">" +
            bar_value_text(bar) + "</td><td>" + bar_text(bar) + "</td></tr>\n";
  }
  return html + "</table>";
}

std::string summary_row(const std::string& name, const Summary& summary, int digits, bool high_is_good = false) {
  if (summary.n == 0) return {};
  return row({name, number(summary.mean, digits), number(summary.median, digits),
              number(high_is_good ? summary.p05 : summary.p95, digits),
              number(high_is_good ? summary.min : summary.max, digits)});
}

std::string figures_table(const EvalReport& report) {
  std::string html = "<table class=\"numbers\">" + row({"", "mean", "median", "worst 5 %", "worst"}, "th");
  html += summary_row("silhouette IoU", report.iou, 3, true);
  for (const ViewScore& view : report.views) {
    html += summary_row("silhouette IoU, " + html_escaped(view.name), view.iou, 3, true);
  }
  html += summary_row("vertex error, mm", report.vertex_mm, 1);
  html += summary_row("vertex error, translation-aligned", report.vertex_aligned_mm, 1);
  if (report.other_mesh) html += summary_row("at the truth's vertices, aligned", report.true_vertex_aligned_mm, 1);
  html += summary_row("to the true surface, translation-aligned", report.surface_mm, 1);
  html += summary_row("loose garments, translation-aligned", report.loose_aligned_mm, 1);
  html += summary_row("joint error, mm", report.joint_mm, 1);
  html += summary_row("joint error, similarity-aligned", report.joint_aligned_mm, 1);
  if (report.other_mesh) {
    html += summary_row("the same points of the body, mm", report.body_point_mm, 1);
    html += summary_row("the same points, similarity-aligned", report.body_point_aligned_mm, 1);
  }
  html += summary_row("the network's own joints, aligned", report.network_joint_aligned_mm, 1);
  return html + "</table>";
}

std::string jitter_cell(const Jitter& jitter) {
  return format("%.1f m/s&sup2; (truth %.1f, captured %.1f)", jitter.error, jitter.truth, jitter.captured);
}

std::string motion_table(const EvalReport& report) {
  std::string html = "<table class=\"facts\">";
  const auto fact = [&](const char* name, const std::string& value) { html += row({name, value}); };
  if (std::isfinite(report.pck_similarity.pck)) {
    fact("3DPCK at 150 mm / AUC, similarity-aligned",
         format("%.3f / %.3f", report.pck_similarity.pck, report.pck_similarity.auc));
    if (std::isfinite(report.pck_root.pck))
      fact("3DPCK at 150 mm / AUC, root-aligned", format("%.3f / %.3f", report.pck_root.pck, report.pck_root.auc));
  }
  if (report.vertex_jitter.n > 0) fact("acceleration error of vertices", jitter_cell(report.vertex_jitter));
  if (report.vertex_jitter_centred.n > 0) {
    fact("&hellip; relative to their centroid", jitter_cell(report.vertex_jitter_centred));
  }
  if (report.joint_jitter.n > 0) fact("acceleration error of joints", jitter_cell(report.joint_jitter));
  if (report.foot_slide.n > 0) {
    fact("foot slide", format("%.0f mm/s (truth %.0f) in %lld steps", report.foot_slide.mm_per_s,
                              report.foot_slide.truth_mm_per_s, static_cast<long long>(report.foot_slide.n)));
  }
  if (std::isfinite(report.at_limit)) {
    std::string worst;
    auto angles = report.angles_at_limit;
    std::sort(angles.begin(), angles.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    for (size_t i = 0; i < std::min<size_t>(3, angles.size()); ++i) {
      worst += format("%s%s %.0f %%", i ? ", " : ": ", angles[i].first.c_str(), 100 * angles[i].second);
    }
    fact("joint angles at a limit", format("%.1f %%", 100 * report.at_limit) + html_escaped(worst));
  }
  if (report.joint_mm.n > 0) {
    fact("arm pulled into the trunk", format("%lld frames", static_cast<long long>(report.n_limb_inside)));
    fact("left and right exchanged",
         format("arms in %lld frames, legs in %lld", static_cast<long long>(report.n_arms_exchanged),
                static_cast<long long>(report.n_legs_exchanged)));
  }
  fact("frames", format("%lld of %lld with a person, %lld tracked, %lld lost, %lld invented",
                        static_cast<long long>(report.n_person), static_cast<long long>(report.n_true_person),
                        static_cast<long long>(report.n_tracked), static_cast<long long>(report.n_lost),
                        static_cast<long long>(report.n_invented)));
  fact("losses",
       format("%lld, %lld recovered, longest %lld frames; %lld frames until first tracked",
              static_cast<long long>(report.losses.n_losses), static_cast<long long>(report.losses.n_recovered),
              static_cast<long long>(report.losses.longest), static_cast<long long>(report.losses.longest_entry)));
  if (std::isfinite(report.speed.latency_ms)) {
    fact("latency", format("%.0f ms median, %.0f ms worst 5 %%, at %.1f fps", report.speed.latency_ms,
                           report.speed.latency_p95_ms, report.speed.fps));
  }
  return html + "</table>";
}

// One value of every frame of `frames` out of another report of the same video; NaN where that has none.
std::vector<double> values_at(const Frames& frames, const EvalReport& report, double FrameEval::*value) {
  std::map<int64_t, double> by_index;
  for (const FrameEval& frame : report.frames) by_index[frame.index] = frame.*value;
  std::vector<double> values;
  for (const FrameEval* frame : frames) {
    const auto found = by_index.find(frame->index);
    values.push_back(found == by_index.end() ? std::numeric_limits<double>::quiet_NaN() : found->second);
  }
  return values;
}

// The paper's plot of its ablation: the vertex error of every stage.
std::string stage_curves(const Ablation& ablation, const Frames& frames) {
  static constexpr const char* kColors[] = {"#b0a8c8", "#5aa469", "#e08214", "#1f5fbf"};
  Chart chart;
  chart.title = "Vertex error of the stages, mm";
  chart.unit = " mm";
  for (const FrameEval* frame : frames) chart.frames.push_back(frame->index);
  for (const AblationRow& row : ablation.rows) {
    if (row.group != ablation.rows[ablation.full].group) continue;
    chart.series.push_back({row.name, kColors[chart.series.size() % std::size(kColors)],
                            values_at(frames, row.draws.front(), &FrameEval::vertex_aligned_mm)});
  }
  return svg_chart(chart);
}

std::string curves(const HtmlReport& input, const Frames& frames) {
  Chart chart;
  for (const FrameEval* frame : frames) {
    chart.frames.push_back(frame->index);
    chart.tracked.push_back(frame->tracked);
  }
  std::string html;
  const auto add = [&](const char* title, const char* unit, int digits, double bar, double FrameEval::*value,
                       bool with_pose, const char* network) {
    chart.title = title;
    chart.unit = unit;
    chart.digits = digits;
    chart.has_bar = bar > 0;
    chart.bar = bar;
    chart.from_zero = digits < 3;
    chart.at_most = digits < 3 ? 0 : 1;
    chart.series = {{"captured", "#1f5fbf", values_at(frames, input.report, value)}};
    if (input.pose_only && with_pose) {
      chart.series.push_back({"pose only", "#e08214", values_at(frames, *input.pose_only, value)});
    }
    if (network) {
      chart.series.push_back({network, "#999999", values_at(frames, input.report, &FrameEval::network_aligned_mm)});
    }
    html += svg_chart(chart);
  };
  add("Silhouette IoU", "", 3, 0.95, &FrameEval::iou, true, nullptr);
  add("Vertex error after translation alignment, mm", " mm", 1, 20, &FrameEval::vertex_aligned_mm, true, nullptr);
  add("Loose garments, mm", " mm", 1, 0, &FrameEval::loose_aligned_mm, true, nullptr);
  add("Joint error after similarity alignment, mm", " mm", 1, 35, &FrameEval::joint_aligned_mm, false, "network only");
  if (input.ablation) html += stage_curves(*input.ablation, frames);
  return html;
}

std::string color_scale(const std::function<Rgb(double)>& color, const std::string& low, const std::string& high) {
  std::string stops;
  for (int i = 0; i <= 10; ++i) {
    const Rgb c = color(i / 10.0);
    stops += format("%srgb(%.0f,%.0f,%.0f) %d%%", i ? "," : "", c[0], c[1], c[2], 10 * i);
  }
  return "<div class=\"scale\"><span>" + low + "</span><i style=\"background:linear-gradient(90deg," + stops +
         ")\"></i><span>" + high + "</span></div>";
}

std::string mesh_figures(const HtmlReport& input, const Actor& actor) {
  const std::vector<float>& mean = input.report.vertex_mean_mm;
  if (mean.empty()) return {};
  const auto figure = [&](const std::vector<Rgb>& colors, const std::string& caption, const std::string& scale) {
    const ImageRgb picture = paint_turnaround(actor.mesh.positions, actor.mesh.triangles, colors, kMeshHeight);
    return "<figure>" + inline_image(encode_png(picture), "png", caption) + "<figcaption>" + caption + scale +
           "</figcaption></figure>";
  };
  std::vector<Rgb> colors;
  for (float error : mean) colors.push_back(heat_color(error / kHeatScaleMm));
  std::string html = figure(colors, "Mean error of every vertex after translation alignment: front, left, back, right.",
                            color_scale(heat_color, "0", format("%.0f mm and more", kHeatScaleMm)));
  if (input.pose_only && input.pose_only->vertex_mean_mm.size() == mean.size()) {
    for (size_t i = 0; i < mean.size(); ++i) {
      colors[i] = diverging_color((input.pose_only->vertex_mean_mm[i] - mean[i]) / kImprovementMm);
    }
    html += figure(colors, "Pose-only error minus this: blue is where the surface stage helps, red where it harms.",
                   color_scale([](double t) { return diverging_color(2 * t - 1); }, format("%.0f mm", -kImprovementMm),
                               format("+%.0f mm", kImprovementMm)));
  }
  return "<div class=\"figures\">" + html + "</div>";
}

std::string frame_caption(const FrameEval& frame) {
  std::string text = format("<b>frame %lld</b>", static_cast<long long>(frame.index));
  if (!frame.tracked) text += " " + html_escaped(frame.status);
  text += " &middot; IoU " + number(frame.iou, 3) + " &middot; vertices " + number(frame.vertex_aligned_mm, 0) +
          " mm &middot; joints " + number(frame.joint_aligned_mm, 0) + " mm";
  if (frame.arms_exchanged) text += " &middot; arms exchanged";
  if (frame.limb_inside) text += " &middot; arm in the trunk";
  if (frame.legs_exchanged) text += " &middot; legs exchanged";
  return text;
}

std::string sheet_figures(const ContactSheet& sheet, const Frames& frames) {
  std::string html;
  for (const FrameEval* frame : frames) {
    const auto picture = sheet.pictures.find(frame->index);
    if (picture == sheet.pictures.end()) continue;
    html +=
        "<figure>" +
        inline_image(encode_jpeg(picture->second), "jpeg", format("frame %lld", static_cast<long long>(frame->index))) +
        "<figcaption>" + frame_caption(*frame) + "</figcaption></figure>";
  }
  return html.empty() ? html : "<div class=\"sheet\">" + html + "</div>";
}

// The five frames with the largest badness, worst first; NaN left out.
Frames worst(const Frames& frames, const std::function<double(const FrameEval&)>& badness) {
  Frames sorted;
  for (const FrameEval* frame : frames) {
    if (std::isfinite(badness(*frame))) sorted.push_back(frame);
  }
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const FrameEval* a, const FrameEval* b) { return badness(*a) > badness(*b); });
  const int64_t apart = std::min(kWorstApart, static_cast<int64_t>(frames.size() / 20));
  Frames chosen;
  for (const FrameEval* frame : sorted) {
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const FrameEval* other) {
      return std::abs(other->index - frame->index) < apart;
    });
    if (!near && chosen.size() < kWorstFrames) chosen.push_back(frame);
  }
  return chosen;
}

Frames evenly(const Frames& frames) {
  Frames chosen;
  const size_t n = std::min(kEvenFrames, frames.size());
  for (size_t i = 0; i < n; ++i) chosen.push_back(frames[(2 * i + 1) * frames.size() / (2 * n)]);
  return chosen;
}

std::string frames_sections(const HtmlReport& input, const Frames& frames) {
  if (input.report.vertex_mean_mm.empty() && input.report.iou.n == 0) return {};
  const Frames even = evenly(frames);
  const Frames by_iou = worst(frames, [](const FrameEval& frame) { return -frame.iou; });
  const Frames by_vertex = worst(frames, [](const FrameEval& frame) { return frame.vertex_aligned_mm; });
  const Frames by_joint = worst(frames, [](const FrameEval& frame) { return frame.joint_aligned_mm; });
  std::vector<int64_t> wanted;
  for (const Frames* list : {&even, &by_iou, &by_vertex, &by_joint}) {
    for (const FrameEval* frame : *list) wanted.push_back(frame->index);
  }
  const ContactSheet sheet = contact_sheet(input.options, input.video, wanted, kSheetHeight);
  std::string panels;
  if (sheet.has_video) panels += "input &middot; ";
  panels += "captured surface";
  if (sheet.has_outline) {
    panels += " &middot; outline (<span class=\"red\">red: missing</span>, <span class=\"blue\">blue: too much</span>)";
  }
  if (sheet.has_error) panels += " &middot; vertex error after translation alignment";
  std::string scale =
      sheet.has_error ? color_scale(heat_color, "0", format("%.0f mm and more", kHeatScaleMm)) : std::string();
  return section("Frames, evenly over the video", panels + scale, sheet_figures(sheet, even)) +
         section("Worst five by vertex error", kApartNote, sheet_figures(sheet, by_vertex)) +
         section("Worst five by joint error", kApartNote, sheet_figures(sheet, by_joint)) +
         section("Worst five by silhouette", kApartNote, sheet_figures(sheet, by_iou));
}

std::string labels_table(const EvalReport& report, const EvalReport* pose_only) {
  if (report.labels.empty()) return {};
  std::vector<std::string> head = {"material", "vertices", "direct, mean", "aligned, mean", "median", "worst 5 %"};
  if (pose_only) head.insert(head.end(), {"pose only", "ratio"});
  std::string html = "<table class=\"numbers\">" + row(head, "th");
  const auto add = [&](const std::string& name, int n, const Summary& direct, const Summary& aligned,
                       const Summary* pose) {
    std::vector<std::string> cells = {html_escaped(name),      format("%d", n),           number(direct.mean, 1),
                                      number(aligned.mean, 1), number(aligned.median, 1), number(aligned.p95, 1)};
    if (pose) {
      cells.push_back(number(pose->mean, 1));
      cells.push_back(number(pose->mean > 0 ? aligned.mean / pose->mean : std::nan(""), 2));
    }
    html += row(cells);
  };
  const bool comparable = pose_only && pose_only->labels.size() == report.labels.size();
  for (size_t i = 0; i < report.labels.size(); ++i) {
    const LabelError& label = report.labels[i];
    add(label.label, label.n_vertices, label.direct, label.aligned,
        comparable ? &pose_only->labels[i].aligned : nullptr);
  }
  add("all", static_cast<int>(report.vertex_mean_mm.size()), report.vertex_mm, report.vertex_aligned_mm,
      comparable ? &pose_only->vertex_aligned_mm : nullptr);
  return html + "</table>";
}

std::string joints_table(const EvalReport& report) {
  if (report.joints_aligned_mm.empty()) return {};
  const bool two_rows = report.other_mesh && report.body_point_mm.n > 0;
  std::string names = two_rows ? "<th></th>" : "", values = two_rows ? "<td>by name</td>" : "", points;
  for (const auto& [name, value] : report.joints_aligned_mm) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    names += "<th>" + html_escaped(words) + "</th>";
    values += "<td>" + number(value, 0) + "</td>";
  }
  if (two_rows) {
    for (const auto& [name, value] : report.body_points_aligned_mm) points += "<td>" + number(value, 0) + "</td>";
    points = "<tr><td>the same points of the body</td>" + points + "</tr>";
  }
  return "<table class=\"numbers joints\"><tr>" + names + "</tr><tr>" + values + "</tr>" + points + "</table>";
}

}  // namespace

std::string html_report(const HtmlReport& input) {
  const CaptureFolder capture =
      open_capture(input.options.capture, input.options.actor, input.options.camera, input.options.truth / "masks");
  Frames frames;
  for (const FrameEval& frame : input.report.frames) frames.push_back(&frame);
  const std::string video = input.video.empty() ? capture.video : input.video;
  const std::filesystem::path folder = std::filesystem::path(video).parent_path().filename();
  const std::string name = folder.empty() ? input.options.truth.parent_path().filename().string() : folder.string();

  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + html_escaped(name) +
                     " &middot; LiveCap evaluation</title><style>" + kHtmlStyle + "</style></head><body><main>\n";
  html += "<header><h1>" + html_escaped(name) + "</h1><p>" +
          format("%lld frames with a person at %.4g fps, %d &times; %d px, %d vertices",
                 static_cast<long long>(input.report.n_person), input.report.video_fps, capture.camera.width,
                 capture.camera.height, capture.actor.n_vertices()) +
          (input.report.run.empty() ? "" : " &middot; " + html_escaped(input.report.run)) + "</p></header>\n";
  html += section("At a glance", "",
                  "<div class=\"columns\"><div>" + bars_table(input.bars) + "</div><div>" +
                      figures_table(input.report) + motion_table(input.report) + "</div></div>");
  if (input.ablation) {
    html += section(
        "What each part is worth",
        "Means over all frames. The change is that of the translation-aligned vertex error against the full method: "
        "positive when leaving the part out makes it worse. Where there are several draws of the network's detections, "
        "means over all of them, how far one is from another (&plusmn;, standard deviation), the standard error of the "
        "change, the worst overlap and the lost frames of all; everything below is of the first draw.",
        ablation_html(*input.ablation));
  }
  html += section("Frame by frame",
                  "Dashed: what the mean is held to. Shaded: not tracked. Point at a frame for its values.",
                  curves(input, frames));
  html += section("On the mesh", "", mesh_figures(input, capture.actor));
  html += section("By material", "Vertex error, mm; aligned: after the translation of the frame.",
                  labels_table(input.report, input.pose_only));
  html +=
      section("By joint", "Mean error after the similarity alignment of the frame, mm.", joints_table(input.report));
  html += frames_sections(input, frames);
  return html + "</main></body></html>\n";
}

}  // namespace livecap
