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
  return report;
}

Ablation table() {
  Ablation ablation;
  ablation.video = "seq/video.mp4";
  ablation.rows = {{"2D + 3D", "Stages", "--no-surface", "", with_vertex_error(30)},
                   {"everything", "Stages", "", "", with_vertex_error(20)},
                   {"without <snapping>", "Parts", "--without snapping", "1.7 %", with_vertex_error(20.34)},
                   {"network only", "Parts", "", "", EvalReport()}};
  ablation.full = 1;
  return ablation;
}

TEST(Ablation, ChangeIsRelativeToTheFullMethod) {
  EXPECT_NEAR(relative_change({1, 20.34, 0, 0, 0, 0, 0}, {1, 20, 0, 0, 0, 0, 0}), 0.017, test::kDoubleExact);
  EXPECT_NEAR(relative_change({1, 10, 0, 0, 0, 0, 0}, {1, 20, 0, 0, 0, 0, 0}), -0.5, test::kDoubleExact);
  EXPECT_TRUE(std::isnan(relative_change({}, {1, 20, 0, 0, 0, 0, 0})));
  EXPECT_TRUE(std::isnan(relative_change({1, 20, 0, 0, 0, 0, 0}, {})));
}

TEST(Ablation, Text) {
  const std::string text = ablation_text(table());
  EXPECT_NE(text.find("+50.0 %"), std::string::npos) << text;
  EXPECT_NE(text.find("+1.7 %"), std::string::npos) << text;
  EXPECT_NE(text.find("Stages\n"), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos);
}

TEST(Ablation, Json) {
  const nlohmann::json json = nlohmann::json::parse(ablation_json(table()));
  ASSERT_EQ(json["rows"].size(), 4u);
  EXPECT_NEAR(json["rows"][0]["change_of_vertex_error"].get<double>(), 0.5, test::kDoubleExact);
  EXPECT_NEAR(json["rows"][0]["vertex_jitter_ratio"].get<double>(), 1.5, test::kDoubleExact);
  EXPECT_TRUE(json["rows"][3]["vertex_translation_aligned_mm"].is_null());
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
