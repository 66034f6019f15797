#include "picture/turnaround.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "livecap/error.h"

namespace livecap {
namespace {

const uint8_t* pixel(const ImageRgb& image, int x, int y) {
  return &image.pixels[3 * (size_t(y) * image.width + x)];
}

TEST(Turnaround, ShowsTheFrontFirstAndTheSubjectsLeftOnTheRight) {
  // A box of 200 x 400 x 100 mm; front vertices at +X green, at -X blue; the back ones red.
  std::vector<float> positions;
  std::vector<Rgb> colors;
  for (float z : {50.0f, -50.0f}) {
    for (float y : {0.0f, 400.0f}) {
      for (float x : {-100.0f, 100.0f}) {
        positions.insert(positions.end(), {x, y, z});
        colors.push_back(z < 0 ? Rgb{255, 0, 0} : x > 0 ? Rgb{0, 255, 0} : Rgb{0, 0, 255});
      }
    }
  }
  const std::vector<int32_t> triangles = {0, 1, 3, 0, 3, 2, 5, 4, 6, 5, 6, 7, 1, 5, 7, 1, 7, 3,
                                          4, 0, 2, 4, 2, 6, 2, 3, 7, 2, 7, 6, 4, 5, 1, 4, 1, 0};
  const ImageRgb image = paint_turnaround(positions, triangles, colors, 100);
  EXPECT_EQ(image.height, 100);
  // 94 px for 400 mm: figures 47, 23.5, 47, 23.5 px wide, 3 px of margin on each side of each.
  ASSERT_NEAR(image.width, 2 * 47 + 2 * 23.5 + 8 * 3, 1);
  const auto strongest = [&](int x) {
    const uint8_t* p = pixel(image, x, 50);
    return p[0] == 255 && p[1] == 255 ? -1 : static_cast<int>(std::max_element(p, p + 3) - p);
  };
  EXPECT_EQ(strongest(0), -1);   // margin
  EXPECT_EQ(strongest(6), 2);    // front, the subject's right: blue
  EXPECT_EQ(strongest(46), 1);   // front, the subject's left: green
  EXPECT_EQ(strongest(59), 1);   // from the left the front is on the left: green
  EXPECT_EQ(strongest(76), 0);   // and the back on the right
  EXPECT_EQ(strongest(105), 0);  // the back
}

TEST(Turnaround, EveryVertexHasAColour) {
  EXPECT_THROW(paint_turnaround(std::vector<float>(9), std::vector<int32_t>{0, 1, 2}, std::vector<Rgb>(2), 10),
               LogicError);
}

}  // namespace
}  // namespace livecap
