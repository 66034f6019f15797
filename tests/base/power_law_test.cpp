#include "base/power_law.h"

#include <gtest/gtest.h>

#include <vector>

namespace livecap {
namespace {

TEST(PowerLaw, ExponentsOfPowersAreFound) {
  const std::vector<double> x = {1000, 5000, 20000, 50000};
  for (double exponent : {-1.0, 0.0, 0.5, 1.0, 2.0}) {
    std::vector<double> y;
    for (double value : x) y.push_back(0.37 * std::pow(value, exponent));
    EXPECT_NEAR(power_law_exponent(x, y), exponent, 1e-12);
  }
}

TEST(PowerLaw, ItIsTheLeastSquaresLine) {
  // By hand: logs to the base 2 are (0, 0), (1, 1), (2, 0), (3, 3); slope = 4 / 5.
  EXPECT_NEAR(power_law_exponent(std::vector<double>{1, 2, 4, 8}, std::vector<double>{1, 2, 1, 8}), 0.8, 1e-12);
}

TEST(PowerLaw, WithoutALineThereIsNone) {
  const auto exponent = [](const std::vector<double>& x, const std::vector<double>& y) {
    return power_law_exponent(x, y);
  };
  EXPECT_TRUE(std::isnan(exponent({}, {})));
  EXPECT_TRUE(std::isnan(exponent({5, 5}, {1, 2})));
  EXPECT_TRUE(std::isnan(exponent({1, 2}, {0, 1})));
  EXPECT_TRUE(std::isnan(exponent({-1, 2}, {1, 1})));
  EXPECT_TRUE(std::isnan(exponent({1, 2}, {1})));
}

}  // namespace
}  // namespace livecap
