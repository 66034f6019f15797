#include "image/pieces.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

namespace livecap {
namespace {

// Noise of a given density: long tangled pieces around one half, specks at the ends.
cv::Mat noise(int width, int height, double density, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution set(density);
  cv::Mat mask(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) mask.at<uint8_t>(y, x) = set(random) ? 255 : 0;
  }
  return mask;
}

TEST(Pieces, AgreeWithOpenCv) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 63}, {63, 1}, {64, 65}, {200, 90}}) {
    for (double density : {0.0, 0.1, 0.4, 0.5, 0.6, 0.9, 1.0}) {
      for (bool diagonal : {false, true}) {
        for (uint8_t value : {0, 255}) {
          const cv::Mat mask = noise(width, height, density, 7);
          const Pieces pieces(mask, value, diagonal);
          cv::Mat labels, stats, centers;
          const cv::Mat chosen = mask == value;
          const cv::Mat place = noise(width, height, 0.3, 8);
          const int n = cv::connectedComponentsWithStats(chosen, labels, stats, centers, diagonal ? 8 : 4, CV_32S);
          ASSERT_EQ(pieces.all().size(), static_cast<size_t>(n - 1));
          // Painting one piece alone must paint exactly one of OpenCV's labels.
          for (size_t k = 0; k < pieces.all().size(); k += 1 + pieces.all().size() / 9) {
            cv::Mat painted(mask.size(), CV_8UC1, cv::Scalar(0));
            std::vector<bool> one(pieces.all().size(), false);
            one[k] = true;
            pieces.paint(painted, one, 1);
            double label = 0;
            cv::minMaxLoc(labels, nullptr, &label, nullptr, nullptr, painted);
            EXPECT_EQ(cv::countNonZero((labels == label) != (painted == 1)), 0);
            const auto stat = [&](int which) { return stats.at<int>(static_cast<int>(label), which); };
            EXPECT_EQ(pieces.all()[k].area, stat(cv::CC_STAT_AREA));
            EXPECT_EQ(pieces.areas_in(place)[k], cv::countNonZero((labels == label) & (place != 0)));
            const bool border = stat(cv::CC_STAT_LEFT) == 0 || stat(cv::CC_STAT_TOP) == 0 ||
                                stat(cv::CC_STAT_LEFT) + stat(cv::CC_STAT_WIDTH) == width ||
                                stat(cv::CC_STAT_TOP) + stat(cv::CC_STAT_HEIGHT) == height;
            EXPECT_EQ(pieces.all()[k].touches_border, border);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace livecap
