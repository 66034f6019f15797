#include "detect/one_euro.h"

#include <gtest/gtest.h>

#include <cmath>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// Computed by hand from the paper's formulas: dt = 0.1, min cut-off 1 Hz, beta 0.5, derivative cut-off 1 Hz, 0 then 1.
// alpha(1 Hz) = 1 / (1 + 1 / (2 pi 0.1)) = 0.3858695; speed = alpha * 10 = 3.858695; cut-off = 1 + 0.5 * 3.858695
// = 2.9293477 Hz; alpha = 1 / (1 + 1 / (2 pi 2.9293477 0.1)) = 0.6479572.
TEST(OneEuro, MatchesHandComputedSteps) {
  const detect::OneEuroOptions options{1.0, 0.5, 1.0};
  detect::OneEuroFilter filter;
  EXPECT_EQ(filter.filter(options, 0.0, 0.1), 0.0);
  const double first = filter.filter(options, 1.0, 0.1);
  EXPECT_NEAR(first, 0.6479572, test::kHandComputed);
  // Standing still: speed decays to 3.8586954 * (1 - 0.3858695) = 2.3697424, cut-off 2.1848712, alpha 0.5785561.
  EXPECT_NEAR(filter.filter(options, 1.0, 0.1), first + 0.5785561 * (1 - first), test::kHandComputed);
}

TEST(OneEuro, ScaleActsOnSpeedOnly) {
  const detect::OneEuroOptions options{1.7, 0.3, 1.0};
  detect::OneEuroFilter small, large;
  for (double t = 0; t < 2; t += 0.1) {
    const double value = std::sin(3 * t);
    // The same motion ten times as large with a tenth of the scale is filtered in the same way.
    EXPECT_NEAR(10 * small.filter(options, value, 0.1, 1.0), large.filter(options, 10 * value, 0.1, 0.1),
                test::kDoubleExact);
  }
}

TEST(OneEuro, ConvergesToAConstantAndForgetsOnReset) {
  const detect::OneEuroOptions options{1.0, 0.1, 1.0};
  detect::OneEuroFilter filter;
  filter.filter(options, 5.0, 0.03);
  double value = 0;
  for (int i = 0; i < 2000; ++i) value = filter.filter(options, -2.0, 0.03);
  EXPECT_NEAR(value, -2.0, test::kDoubleExact);
  filter.reset();
  EXPECT_EQ(filter.filter(options, 40.0, 0.03), 40.0);
}

TEST(OneEuro, BadOptionsAreRefused) {
  EXPECT_THROW((detect::OneEuroOptions{0, 0.1, 1}.validate()), ConfigError);
  EXPECT_THROW((detect::OneEuroOptions{1, -0.1, 1}.validate()), ConfigError);
  EXPECT_THROW((detect::OneEuroOptions{1, 0.1, NAN}.validate()), ConfigError);
}

}  // namespace
}  // namespace livecap
