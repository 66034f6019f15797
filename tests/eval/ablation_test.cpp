// The table of an ablation: changes against the full method, missing figures, all three forms.
#include "eval/ablation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/tolerances.h"

namespace livecap {
namespace {

EvalReport with_vertex_error(double mm) {
  EvalReport report;
  report.iou = {10, 0.95, 0.95, 0.9, 1, 0.9, 1};
  report.vertex_aligned_mm = {100, mm, mm, mm, mm, mm, mm};
  report.vertex_jitter = {10, 3, 1, 2};
  report.labels = {{"hair", 1, {}, {30, 8, 8, 8, 8, 8, 8}},
                   {"skirt", 1, {}, {9, 99, 9, 9, 9, 9, 9}},
                   {"face", 1, {}, {10, 4, 4, 4, 4, 4, 4}}};
  return report;
}

Ablation table() {
  Ablation ablation;
  ablation.video = "seq/video.mp4";
  ablation.rows = {{"2D + 3D", "Stages", "--no-surface", "", {with_vertex_error(30)}},
                   {"everything", "Stages", "", "", {with_vertex_error(20)}},
                   {"without <snapping>", "Parts", "--without snapping", "1.7 %", {with_vertex_error(20.34)}},
                   {"network only", "Parts", "", "", {EvalReport()}}};
  ablation.full = 1;
  return ablation;
}

TEST(Ablation, ChangeIsRelativeToTheFullMethod) {
  const auto change = [](const EvalReport& row, const EvalReport& full) {
    return vertex_change({"", "", "", "", {row}}, {"", "", "", "", {full}}).change;
  };
  EXPECT_NEAR(change(with_vertex_error(20.34), with_vertex_error(20)), 0.017, test::kDoubleExact);
  EXPECT_NEAR(change(with_vertex_error(10), with_vertex_error(20)), -0.5, test::kDoubleExact);
  EXPECT_TRUE(std::isnan(change({}, with_vertex_error(20))));
  EXPECT_TRUE(std::isnan(change(with_vertex_error(20), {})));
}

// Three draws, one of them bad: their mean, how far one is from another, the worst overlap and all lost frames.
TEST(Ablation, DrawsAreAveraged) {
  Ablation ablation = table();
  ablation.rows[0].draws = {with_vertex_error(20), with_vertex_error(23), with_vertex_error(29)};
  ablation.rows[0].draws[1].iou.min = 0.7;
  ablation.rows[0].draws[0].n_lost = 1;
  ablation.rows[0].draws[2].n_lost = 3;
  const DrawnError error = vertex_error(ablation.rows[0]);
  EXPECT_NEAR(error.mean_mm, 24, test::kDoubleExact);
  EXPECT_NEAR(error.deviation_mm, std::sqrt(21.0), test::kDoubleExact);  // (16 + 1 + 25) / 2
  const nlohmann::json row = nlohmann::json::parse(ablation_json(ablation))["rows"][0];
  EXPECT_EQ(row["draws"], 3);
  EXPECT_NEAR(row["vertex_translation_aligned_mm"].get<double>(), 24, test::kDoubleExact);
  EXPECT_NEAR(row["change_of_vertex_error"].get<double>(), 0.2, test::kDoubleExact);
  EXPECT_NEAR(row["iou_worst"].get<double>(), 0.7, test::kDoubleExact);
  EXPECT_EQ(row["frames_lost"], 4);
  EXPECT_TRUE(row["standard_error_of_change"].is_null());  // the full method has one draw
  EXPECT_NE(ablation_text(ablation).find("24.0    4.6         +20.0 %"), std::string::npos) << ablation_text(ablation);
  const std::string html = ablation_html(ablation);
  EXPECT_NE(html.find("<th>&plusmn;</th>"), std::string::npos);
  EXPECT_NE(html.find("colspan=\"12\""), std::string::npos);
  EXPECT_NE(html.find("<td>4.6</td>"), std::string::npos);
}

// Draws that are far apart, and a part that costs each of them nearly the same.
TEST(Ablation, TheChangeIsPairedByDraw) {
  const AblationRow full{"", "", "", "", {with_vertex_error(20), with_vertex_error(40), with_vertex_error(30)}};
  const AblationRow row{"", "", "", "", {with_vertex_error(22), with_vertex_error(43), with_vertex_error(34)}};
  const VertexChange change = vertex_change(row, full);
  EXPECT_NEAR(change.change, 0.1, test::kDoubleExact);
  EXPECT_NEAR(change.standard_error, 1 / std::sqrt(3.0) / 30, test::kDoubleExact);  // of 2, 3 and 4 mm
  Ablation ablation;
  ablation.rows = {full, row};
  EXPECT_NE(ablation_text(ablation).find("+10.0 % +- 1.9"), std::string::npos) << ablation_text(ablation);
}

TEST(Ablation, Text) {
  const std::string text = ablation_text(table());
  EXPECT_NE(text.find("+50.0 %"), std::string::npos) << text;
  EXPECT_NE(text.find("+1.7 %"), std::string::npos) << text;
  EXPECT_NE(text.find("Stages\n"), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("+-"), std::string::npos);  // one draw of each
  EXPECT_EQ(ablation_html(table()).find("&plusmn;"), std::string::npos);
}

// A folder's name need not be UTF-8, and hours of work must not end at it.
TEST(Ablation, JsonOfANameThatIsNoUtf8) {
  Ablation ablation = table();
  ablation.video = "caf\xe9/video.mp4";
  EXPECT_EQ(nlohmann::json::parse(ablation_json(ablation))["video"], "caf\xef\xbf\xbd/video.mp4");
}

TEST(Ablation, Json) {
  const nlohmann::json json = nlohmann::json::parse(ablation_json(table()));
  ASSERT_EQ(json["rows"].size(), 4u);
  EXPECT_NEAR(json["rows"][0]["change_of_vertex_error"].get<double>(), 0.5, test::kDoubleExact);
  EXPECT_NEAR(json["rows"][0]["vertex_jitter_ratio"].get<double>(), 1.5, test::kDoubleExact);
  EXPECT_NEAR(json["rows"][0]["head_translation_aligned_mm"].get<double>(), 7, test::kDoubleExact);
  EXPECT_TRUE(json["rows"][3]["vertex_translation_aligned_mm"].is_null());
  EXPECT_TRUE(json["rows"][0]["vertex_standard_deviation_of_draws_mm"].is_null());  // one draw has none
  EXPECT_EQ(json["rows"][2]["paper"], "1.7 %");
}

TEST(Ablation, HtmlEscapesAndMarksTheFullRow) {
  const std::string html = ablation_html(table());
  EXPECT_NE(html.find("without &lt;snapping&gt;"), std::string::npos);
  EXPECT_NE(html.find("<tr class=\"full\"><td title=\"\">everything"), std::string::npos) << html;
  EXPECT_NE(html.find("class=\"worse\">+1.7 %"), std::string::npos);
}

}  // namespace
}  // namespace livecap
