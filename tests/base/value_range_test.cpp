#include "base/value_range.h"

#include <gtest/gtest.h>

#include <cmath>

#include "livecap/error.h"
#include "support/refusal.h"

namespace livecap {
namespace {

TEST(ValueRange, HasBothEnds) {
  constexpr ValueRange range{3, 30};
  EXPECT_TRUE(range.contains(3) && range.contains(30));
  EXPECT_FALSE(range.contains(2.99) || range.contains(30.01) || range.contains(NAN));
}

TEST(ValueRange, IsSaidToWhoLeavesIt) {
  EXPECT_NO_THROW(require_within("--grid", 30, {3, 30}, "mm"));
  test::expect_refused<ConfigError>(
      [] {
        require_within("--grid", 50, {3, 30}, "mm");
      },
      {"--grid 50: must be between 3 and 30 mm"});
  test::expect_refused<ConfigError>([] { require_within("--height", NAN, {0.8, 2.5}); }, {"--height", "0.8 and 2.5"});
}

}  // namespace
}  // namespace livecap
