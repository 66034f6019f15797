#include "report/actor_report.h"

#include <algorithm>
#include <map>

#include "actor/inspect.h"
#include "actor/labels.h"
#include "base/html_text.h"
#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "picture/color_scale.h"
#include "report/turnaround_strip.h"

namespace livecap {

namespace {

std::string picture(const ImageRgb& image, const std::string& caption) {
  return "<h2>" + html_escaped(caption) + "</h2>\n" + inline_image(encode_png(image), "png", caption) + "\n";
}

std::string list(const std::vector<std::string>& lines) {
  std::string text = "<ul>\n";
  for (const std::string& line : lines) text += "<li>" + html_escaped(line) + "</li>\n";
  return text + "</ul>\n";
}

std::string label_legend(const Actor& actor) {
  std::map<int, int> counts;
  for (uint8_t label : actor.labels) ++counts[label];
  std::string text = "<p>";
  for (const auto& [label, count] : counts) {
    const Rgb c = label_color(label);
    text += format("<span style=\"background:rgb(%d,%d,%d)\">&nbsp;&nbsp;&nbsp;</span> %s (%d) &nbsp; ",
                   static_cast<int>(c[0]), static_cast<int>(c[1]), static_cast<int>(c[2]),
                   std::string(kLabelNames[label]).c_str(), count);
  }
  return text + "</p>\n";
}

// Poses that show what skinning does: arms down, arms up, a step, a squat, a twist of the head, a hug.
std::vector<Eigen::VectorXd> check_poses(const Skeleton& skeleton) {
  constexpr double kDegree = M_PI / 180;
  const std::vector<std::map<std::string, double>> poses = {
      {{"left_shoulder_z", -75}, {"right_shoulder_z", 75}},
      {{"left_shoulder_z", 70}, {"right_shoulder_z", -70}, {"left_clavicle_z", 20}, {"right_clavicle_z", -20}},
      {{"left_hip_x", -60},
       {"left_knee_x", 60},
       {"right_hip_x", 15},
       {"right_knee_x", 20},
       {"left_shoulder_z", -60},
       {"right_shoulder_z", 60}},
      {{"left_hip_x", -95},
       {"left_knee_x", 110},
       {"left_ankle_x", -20},
       {"right_hip_x", -95},
       {"right_knee_x", 110},
       {"right_ankle_x", -20},
       {"left_shoulder_y", -70},
       {"right_shoulder_y", 70}},
      {{"neck_y", 55},
       {"neck_x", 15},
       {"left_shoulder_z", -50},
       {"left_elbow_y", -110},
       {"right_shoulder_z", 50},
       {"right_shoulder_x", 60},
       {"right_elbow_y", 90}},
      {{"left_shoulder_y", -85},
       {"left_elbow_y", -60},
       {"right_shoulder_y", 85},
       {"right_elbow_y", 60},
       {"left_hip_z", 35},
       {"right_hip_z", -35}}};
  std::vector<Eigen::VectorXd> angles;
  for (const auto& pose : poses) {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(skeleton.n_dofs());
    for (int d = 0; d < skeleton.n_dofs(); ++d)
      if (const auto found = pose.find(skeleton.dofs[d].name); found != pose.end()) a[d] = found->second * kDegree;
    angles.push_back(a);
  }
  return angles;
}

}  // namespace

std::string comparison_html(const Actor& actor, const std::string& text, const std::vector<double>& distances_mm,
                            const std::vector<char>& hidden) {
  constexpr double kFullMm = 20;
  std::vector<float> colors;
  for (size_t i = 0; i < distances_mm.size(); ++i) {
    const float left = 1 - static_cast<float>(std::min(1.0, distances_mm[i] / kFullMm));
    if (!hidden.empty() && hidden[i])
      colors.insert(colors.end(), {0.4f, 0.5f, 1.0f});
    else
      colors.insert(colors.end(), {1.0f, left, left});
  }
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>actor compare</title>\n<style>body{"
         "font-family:sans-serif;margin:2em}img{max-width:100%}pre{background:#f4f4f4;padding:1em}</style></head>"
         "<body>\n" +
         picture(
             painted_strip(actor, colors),
             "Distance to the true surface: white 0, red 20 mm and more, blue concavities and what no camera sees") +
         "<pre>" + html_escaped(text) + "</pre>\n</body></html>\n";
}

std::string actor_report_html(const Actor& actor, const ReportText& text) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
                     html_escaped(text.title) +
                     "</title>\n<style>body{font-family:sans-serif;margin:2em;max-width:1840px}img{max-width:100%}"
                     "pre{background:#f4f4f4;padding:1em;overflow:auto}</style></head><body>\n<h1>" +
                     html_escaped(text.title) + "</h1>\n" + list(text.facts);
  html += text.notes.empty() ? "<p>No warnings.</p>\n" : "<h2>Warnings</h2>\n" + list(text.notes);
  constexpr int kViews = 6;
  html += picture(turnaround_strip(actor, StripColor::kTexture, kViews), "From all around");
  html += picture(turnaround_strip(actor, StripColor::kShape, kViews, true), "Shape, joints and face markers");
  html += picture(turnaround_strip(actor, StripColor::kWeights, kViews), "Skinning weights");
  html += picture(turnaround_strip(actor, StripColor::kLabels, kViews), "Materials") + label_legend(actor);
  html += picture(pose_strip(actor, check_poses(actor.skeleton)), "Posed");
  return html + "<h2>livecap actor inspect</h2>\n<pre>" + html_escaped(inspect_actor(actor)) +
         "</pre>\n</body></html>\n";
}

}  // namespace livecap
