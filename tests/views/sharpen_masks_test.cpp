// A figure in a striped shirt before a wall with a pattern, drawn here; the network's mask is too wide and lacks the
// feet.
#include "views/sharpen_masks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "image/mask_iou.h"

namespace livecap {
namespace {

constexpr int kWide = 240, kHigh = 480;

struct Figure {
  ImageRgb picture{kWide, kHigh, std::vector<uint8_t>(3 * kWide * kHigh)};
  ImageGray truth{kWide, kHigh, std::vector<uint8_t>(kWide* kHigh)};
  ImageGray network = truth;
};

// aside_px: the figure stands beside the middle by so much. seen: else it has the colours of the wall.
Figure draw(double aside_px, bool seen) {
  Figure figure;
  std::mt19937 random(5);
  const auto inside = [&](double x, double y, double wider) {
    const double across = std::abs(x - kWide / 2.0 - aside_px);
    if (std::hypot(across, y - 60) < 30 + wider) return true;                         // head
    if (y > 90 - wider && y < 260 + wider && across < 45 + wider) return true;        // trunk
    return y >= 260 && y < 440 + wider && across > 8 - wider && across < 34 + wider;  // legs
  };
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) {
      const size_t p = size_t(y) * kWide + x;
      const bool person = inside(x, y, 0);
      for (int c = 0; c < 3; ++c) {
        const double wall = 150 + 25 * std::sin(x / 11.0 + c) + 25 * std::sin(y / 13.0 + 2 * c);
        const double clothes = y < 260 ? 60 + 40 * (y / 10 % 2) + 20 * c : 40 + 15 * c;
        figure.picture.pixels[3 * p + c] =
            static_cast<uint8_t>((person && seen ? clothes : wall) + static_cast<int>(random() % 7) - 3);
      }
      figure.truth.pixels[p] = person ? 255 : 0;
      figure.network.pixels[p] = y < 434 && inside(x, y, 4) ? 255 : 0;
    }
  return figure;
}

TEST(SharpenMasks, OutlinesMoveToWhereThePictureHasThem) {
  const Figure figure = draw(0, true);
  const double before = mask_iou(figure.network, figure.truth);
  const double after = mask_iou(sharpened_mask(figure.picture, figure.network), figure.truth);
  EXPECT_GT(1 - before, 5 * (1 - after));
}

TEST(SharpenMasks, FurtherAwayTheMaskStays) {
  Figure figure = draw(0, true);
  const auto moved_px = [&](const ImageGray& mask) {  // the highest and lowest row that has the person
    int highest = kHigh, lowest = 0;
    for (size_t p = 0; p < mask.pixels.size(); ++p)
      if (mask.pixels[p] > 127) highest = std::min(highest, int(p / kWide)), lowest = std::max(lowest, int(p / kWide));
    return std::pair(highest, lowest);
  };
  for (size_t p = size_t(kWide) * 400; p < figure.network.pixels.size(); ++p) figure.network.pixels[p] = 0;
  const auto [given_top, given_bottom] = moved_px(figure.network);
  const auto [top, bottom] = moved_px(sharpened_mask(figure.picture, figure.network));
  EXPECT_NEAR(bottom, given_bottom, 10) << "40 px of the legs are not the network's to lose";
  EXPECT_NEAR(top, given_top, 10);
}

TEST(SharpenMasks, WhoIsNotToBeToldFromTheWallKeepsTheMask) {
  const Figure figure = draw(0, false);
  EXPECT_GT(mask_iou(sharpened_mask(figure.picture, figure.network), figure.network), 0.75);
}

TEST(SharpenMasks, MasksOfNobodyOfAFewPixelsAndOfEverythingStay) {
  const Figure figure = draw(0, true);
  for (uint8_t value : {0, 255}) {
    const ImageGray mask{kWide, kHigh, std::vector<uint8_t>(figure.truth.pixels.size(), value)};
    EXPECT_EQ(sharpened_mask(figure.picture, mask).pixels, mask.pixels) << int(value);
  }
  ImageGray speck{kWide, kHigh, std::vector<uint8_t>(figure.truth.pixels.size())};
  for (int x : {50, 51, 52}) speck.pixels[kWide * 100 + x] = 255;
  EXPECT_EQ(sharpened_mask(figure.picture, speck).pixels, speck.pixels) << "GrabCut needs five pixels of each";
}

TEST(SharpenMasks, ManyViewsAreAsOne) {
  std::vector<View> views;
  for (int i = 0; i < 7; ++i) {
    const Figure figure = draw(5 * i - 15, true);
    View view;
    view.image = figure.picture;
    view.mask = figure.network;
    views.push_back(view);
  }
  const std::vector<View> before = views;
  const std::vector<size_t> which = {0, 1, 3, 4, 6};
  int last = 0;
  sharpen_masks(views, which, [&](int done, int total) {
    EXPECT_EQ(total, 5);
    EXPECT_GT(done, last);
    last = done;
  });
  EXPECT_EQ(last, 5);
  for (size_t i = 0; i < views.size(); ++i) {
    const bool sharpened = std::find(which.begin(), which.end(), i) != which.end();
    EXPECT_EQ(views[i].mask.pixels,
              sharpened ? sharpened_mask(before[i].image, before[i].mask).pixels : before[i].mask.pixels)
        << i;
  }
  EXPECT_THROW(sharpen_masks(views, which, [](int, int) { throw std::runtime_error("interrupted"); }),
               std::runtime_error);
}

}  // namespace
}  // namespace livecap
