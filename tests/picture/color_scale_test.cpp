#include "picture/color_scale.h"

#include <gtest/gtest.h>

#include <set>

#include "actor/labels.h"

namespace livecap {
namespace {

TEST(ColorScale, ScalesEndWhereTheySay) {
  EXPECT_EQ(heat_color(-1), heat_color(0));
  EXPECT_EQ(heat_color(2), heat_color(1));
  EXPECT_GT(heat_color(0)[2], heat_color(1)[2]);
  EXPECT_GT(diverging_color(-1)[0], diverging_color(-1)[2]);  // red: worse
  EXPECT_GT(diverging_color(1)[2], diverging_color(1)[0]);    // blue: better
  EXPECT_EQ(diverging_color(0)[0], diverging_color(0)[1]);    // grey
}

TEST(ColorScale, ColoursOfManyValuesAreThoseOfOne) {
  const std::vector<double> values = {0, 15, 30, 90};
  const std::vector<float> colors = heat_colors(values, 30);
  ASSERT_EQ(colors.size(), 3 * values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(colors[3 * i + k], heat_color(values[i] / 30)[k] / 255);
  }
}

TEST(ColorScale, EveryLabelHasItsOwnColour) {
  std::set<Rgb> colors;
  for (size_t label = 0; label < kLabelNames.size(); ++label) colors.insert(label_color(static_cast<int>(label)));
  EXPECT_EQ(colors.size(), kLabelNames.size());
  EXPECT_GT(hue_color(0, 1)[0], hue_color(0, 1)[1]);  // the circle begins at red
}

}  // namespace
}  // namespace livecap
