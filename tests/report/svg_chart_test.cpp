// Curves: where a value lies in the picture, what is left out.
#include "report/svg_chart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

TEST(SvgChart, StepsAreOneTwoOrFive) {
  EXPECT_NEAR(nice_step(1, 5), 0.2, test::kDoubleExact);
  EXPECT_NEAR(nice_step(0.25, 5), 0.05, test::kDoubleExact);
  EXPECT_NEAR(nice_step(140, 5), 50, test::kDoubleExact);  // 28 a step
  EXPECT_NEAR(nice_step(10, 10), 1, test::kDoubleExact);
  EXPECT_EQ(nice_step(0, 5), 1);
  EXPECT_EQ(nice_step(std::nan(""), 5), 1);
}

Chart chart() {
  Chart chart;
  chart.title = "Error <mm>";
  chart.frames = {10, 11, 12};
  chart.series = {{"a", "#123456", {0, 50, 100}}};
  return chart;
}

TEST(SvgChart, TheCurveRunsFromCornerToCorner) {
  // Frames 10..12 span x 56..1104, values 0..100 y 220..34 of a picture of 1120 x 250.
  const std::string svg = svg_chart(chart());
  EXPECT_NE(svg.find("M56.0 220.0L580.0 127.0L1104.0 34.0"), std::string::npos) << svg;
  EXPECT_NE(svg.find("frame 11\na: 50.0"), std::string::npos);
  EXPECT_NE(svg.find("mean 50.0"), std::string::npos);
  EXPECT_NE(svg.find("Error &lt;mm&gt;"), std::string::npos);
}

TEST(SvgChart, AGapIsNotDrawnOver) {
  Chart gap = chart();
  gap.series[0].values[1] = std::nan("");
  const std::string svg = svg_chart(gap);
  EXPECT_NE(svg.find("M56.0 220.0M1104.0 34.0"), std::string::npos) << svg;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(SvgChart, LostFramesAreShaded) {
  Chart lost = chart();
  EXPECT_EQ(svg_chart(lost).find("class=\"lost\""), std::string::npos);
  lost.tracked = {true, false, true};
  EXPECT_NE(svg_chart(lost).find("class=\"lost\""), std::string::npos);
}

TEST(SvgChart, NothingGivesNothing) {
  Chart empty = chart();
  empty.series[0].values.assign(3, std::nan(""));
  EXPECT_EQ(svg_chart(empty), "");
  empty.series[0].values.resize(2);
  EXPECT_THROW(svg_chart(empty), LogicError);
}

TEST(SvgChart, OneFrameOfOneValue) {
  Chart one = chart();
  one.frames = {5};
  one.series[0].values = {0};
  EXPECT_NE(svg_chart(one).find("M56.0 220.0"), std::string::npos);
}

}  // namespace
}  // namespace livecap
