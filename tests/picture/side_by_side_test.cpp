#include "picture/side_by_side.h"

#include <gtest/gtest.h>

#include <vector>

#include "livecap/error.h"

namespace livecap {
namespace {

TEST(SideBySide, RowsContinueInTheNextPictureAfterTheGap) {
  const std::vector<ImageRgb> pictures = {{1, 2, {1, 2, 3, 4, 5, 6}},
                                          {2, 2, {7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18}}};
  const ImageRgb joined = side_by_side(pictures);
  EXPECT_EQ(joined.width, 3);
  EXPECT_EQ(joined.height, 2);
  EXPECT_EQ(joined.pixels, (std::vector<uint8_t>{1, 2, 3, 7, 8, 9, 10, 11, 12, 4, 5, 6, 13, 14, 15, 16, 17, 18}));
  const ImageRgb apart = side_by_side(pictures, 1);
  EXPECT_EQ(apart.width, 4);
  EXPECT_EQ(apart.pixels, (std::vector<uint8_t>{1, 2, 3, 255, 255, 255, 7,  8,  9,  10, 11, 12,
                                                4, 5, 6, 255, 255, 255, 13, 14, 15, 16, 17, 18}));
}

TEST(SideBySide, WantsPicturesOfOneHeight) {
  EXPECT_THROW(side_by_side({}), LogicError);
  const std::vector<ImageRgb> pictures = {{1, 1, {0, 0, 0}}, {1, 2, {0, 0, 0, 0, 0, 0}}};
  EXPECT_THROW(side_by_side(pictures), LogicError);
}

}  // namespace
}  // namespace livecap
