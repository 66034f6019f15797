// Overlap of masks against counts by hand.
#include "image/mask_iou.h"

#include <gtest/gtest.h>

#include <vector>

#include "livecap/error.h"

namespace livecap {
namespace {

ImageGray mask(int width, int height, const std::vector<uint8_t>& pixels) {
  return {width, height, pixels};
}

TEST(MaskIou, CountsPixelsAtOrAboveHalf) {
  // Set in a: 0,1,2; in b: 1,2,3,4. Both: 2 pixels, any: 5.
  const ImageGray a = mask(3, 2, {255, 128, 200, 127, 0, 0});
  const ImageGray b = mask(3, 2, {0, 255, 255, 255, 128, 0});
  EXPECT_DOUBLE_EQ(mask_iou(a, b), 2.0 / 5.0);
  EXPECT_DOUBLE_EQ(mask_iou(b, a), 2.0 / 5.0);
  EXPECT_DOUBLE_EQ(mask_iou(a, a), 1.0);
}

TEST(MaskIou, OfDisjointAndEmptyMasks) {
  const ImageGray left = mask(2, 1, {255, 0});
  const ImageGray right = mask(2, 1, {0, 255});
  const ImageGray none = mask(2, 1, {0, 0});
  EXPECT_DOUBLE_EQ(mask_iou(left, right), 0.0);
  EXPECT_DOUBLE_EQ(mask_iou(left, none), 0.0);
  EXPECT_DOUBLE_EQ(mask_iou(none, none), 1.0);
  EXPECT_FALSE(mask_has_person(none));
  EXPECT_TRUE(mask_has_person(right));
}

TEST(MaskIou, RefusesDifferentSizes) {
  EXPECT_THROW(mask_iou(mask(2, 1, {0, 0}), mask(1, 2, {0, 0})), LogicError);
}

}  // namespace
}  // namespace livecap
