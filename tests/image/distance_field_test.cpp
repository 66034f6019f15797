#include "image/distance_field.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

namespace livecap {
namespace {

// OpenCV's exact transform of either side. Squared distances are whole numbers and their roots rounded once, so the two
// must agree bit for bit.
cv::Mat opencv_signed_distance(const cv::Mat& inside) {
  const cv::Mat outside = inside == 0;
  cv::Mat to_inside, to_outside;
  cv::distanceTransform(outside, to_inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::distanceTransform(inside, to_outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::Mat distance = to_inside - cv::Scalar(0.5f);
  cv::Mat(cv::Scalar(0.5f) - to_outside).copyTo(distance, inside);
  return distance;
}

TEST(DistanceField, AgreesWithOpenCv) {
  std::mt19937 random(3);
  for (const auto& [width, height] : {std::pair{2, 1}, {1, 2}, {64, 63}, {65, 40}, {301, 207}}) {
    for (double density : {0.001, 0.03, 0.5, 0.97, 0.999}) {
      std::bernoulli_distribution set(density);
      cv::Mat inside(height, width, CV_8UC1);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) inside.at<uint8_t>(y, x) = set(random) ? 255 : 0;
      }
      inside.at<uint8_t>(0, 0) = 0;  // both kinds
      inside.at<uint8_t>(height - 1, width - 1) = 255;
      cv::Mat distance(inside.size(), CV_32FC1);
      signed_distance(inside, distance);
      EXPECT_EQ(cv::countNonZero(distance != opencv_signed_distance(inside)), 0)
          << width << "x" << height << ", " << density;
    }
  }
}

}  // namespace
}  // namespace livecap
