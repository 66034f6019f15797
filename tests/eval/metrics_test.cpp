// Metrics against values worked out by hand.
#include "eval/metrics.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::kDoubleExact;
using test::kFloatRelative;

TEST(Metrics, PointDistances) {
  const std::vector<float> a = {0, 0, 0, 1, 1, 1};
  const std::vector<float> b = {3, 4, 0, 1, 1, 3};
  EXPECT_EQ(point_distances(a, b), (std::vector<double>{5, 2}));
  EXPECT_THROW(point_distances(a, std::vector<float>(3)), LogicError);
  EXPECT_TRUE(point_distances({}, {}).empty());
}

TEST(Metrics, TranslationAlignmentRemovesTheMeanOffsetOnly) {
  // Differences (2,0,0) and (4,0,0): mean (3,0,0), one unit remains on each.
  const std::vector<float> a = {2, 0, 0, 14, 0, 0};
  const std::vector<float> b = {0, 0, 0, 10, 0, 0};
  EXPECT_EQ(translation_aligned_distances(a, b), (std::vector<double>{1, 1}));
}

TEST(Metrics, TranslationAlignmentLeavesARotation) {
  // A square against itself turned by 180 degrees: the centroids agree, every corner is one diagonal away.
  const std::vector<float> square = {1, 1, 0, -1, 1, 0, -1, -1, 0, 1, -1, 0};
  const std::vector<float> turned = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  for (double distance : translation_aligned_distances(square, turned)) {
    EXPECT_NEAR(distance, 2 * std::sqrt(2.0), kDoubleExact);
  }
}

TEST(Metrics, SimilarityAlignmentUndoesRotationScaleAndTranslation) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0, 300);
  std::vector<float> truth(3 * 14);
  for (float& value : truth) value = normal(random);
  const Eigen::Matrix3f rotation =
      Eigen::AngleAxisf(2.2f, Eigen::Vector3f(1, -2, 0.5f).normalized()).toRotationMatrix();
  std::vector<float> moved = truth;
  for (int i = 0; i < 14; ++i) {
    Eigen::Map<Eigen::Vector3f> point(&moved[3 * i]);
    point = (0.7f * (rotation * point) + Eigen::Vector3f(100, -2000, 3500)).eval();
  }
  for (double distance : similarity_aligned_distances(moved, truth)) EXPECT_LT(distance, 3500 * kFloatRelative);
  EXPECT_GT(summarize(translation_aligned_distances(moved, truth)).mean, 100);
}

TEST(Metrics, SimilarityAlignmentAllowsNoReflection) {
  // A tetrahedron and its mirror image cannot be brought together.
  const std::vector<float> shape = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<float> mirrored = {0, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_GT(summarize(similarity_aligned_distances(mirrored, shape)).max, 0.1);
}

TEST(Metrics, SimilarityAlignmentLeavesWhatIsNotASimilarity) {
  // Stretched along x by 3 against a cross of radius 1. By symmetry the best rotation is none and the best scale is
  // s = sum(a.b)/sum(a.a) = (2*3 + 2*1)/(2*9 + 2*1) = 0.4: the x points end 0.2 outside, the y points 0.6 inside.
  const std::vector<float> stretched = {3, 0, 0, -3, 0, 0, 0, 1, 0, 0, -1, 0};
  const std::vector<float> cross = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0};
  const std::vector<double> distances = similarity_aligned_distances(stretched, cross);
  ASSERT_EQ(distances.size(), 4u);
  EXPECT_NEAR(distances[0], 0.2, kDoubleExact);
  EXPECT_NEAR(distances[1], 0.2, kDoubleExact);
  EXPECT_NEAR(distances[2], 0.6, kDoubleExact);
  EXPECT_NEAR(distances[3], 0.6, kDoubleExact);
}

TEST(Metrics, SimilarityAlignmentOfDegeneratePoints) {
  const std::vector<float> same(9, 5.0f);
  const std::vector<float> spread = {-1, 0, 0, 0, 0, 0, 1, 0, 0};
  EXPECT_EQ(similarity_aligned_distances(same, spread), (std::vector<double>{1, 0, 1}));
  EXPECT_THROW(similarity_aligned_distances(std::vector<float>(6), std::vector<float>(6)), LogicError);
}

TEST(Metrics, SummaryOfKnownValues) {
  std::vector<double> values;
  for (int i = 100; i >= 0; --i) values.push_back(i);
  const Summary summary = summarize(values);
  EXPECT_EQ(summary.n, 101);
  EXPECT_DOUBLE_EQ(summary.mean, 50);
  EXPECT_DOUBLE_EQ(summary.median, 50);
  EXPECT_DOUBLE_EQ(summary.p05, 5);
  EXPECT_DOUBLE_EQ(summary.p95, 95);
  EXPECT_DOUBLE_EQ(summary.min, 0);
  EXPECT_DOUBLE_EQ(summary.max, 100);
  EXPECT_DOUBLE_EQ(summarize({1, 2}).median, 1.5);
  EXPECT_DOUBLE_EQ(summarize({3}).p95, 3);
}

TEST(Metrics, TheMeanOfNothingIsNoNumber) {
  EXPECT_EQ(mean_of({1, 2, NAN}), 1.5);
  EXPECT_TRUE(std::isnan(mean_of({NAN})));
  EXPECT_TRUE(std::isnan(mean_of({})));
  EXPECT_TRUE(std::isnan(mean_or_nan({})));
}

TEST(Metrics, SummaryLeavesOutWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Summary summary = summarize({1, nan, 3, INFINITY});
  EXPECT_EQ(summary.n, 2);
  EXPECT_DOUBLE_EQ(summary.mean, 2);
  EXPECT_EQ(summarize({}).n, 0);
}

}  // namespace
}  // namespace livecap
