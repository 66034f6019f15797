#include "base/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/text.h"
#include "support/comma_locale.h"

namespace livecap {
namespace {

TEST(NumberText, HasTheDigitsOfPrintf) {
  for (double value : {0.0, -0.0, 1.5, -2.0 / 3, 1e-7, 123456789.123456789, 1e300, -5e-324, 0.5, 2.5, 1e21})
    for (int digits : {0, 1, 6, 9, 17}) {
      EXPECT_EQ(fixed_text(value, digits), format("%.*f", digits, value));
      EXPECT_EQ(general_text(value, digits), format("%.*g", digits, value));
    }
}

TEST(NumberText, ReadsWhatStandsInFront) {
  const std::string text = " \t+1.5e2 -7x nan -inf 1,5 +-1 1e999";
  const char *at = text.data(), *end = at + text.size();
  double value = 0;
  at = read_number(at, end, value);
  EXPECT_EQ(value, 150);
  at = read_number(at, end, value);
  EXPECT_EQ(value, -7);
  EXPECT_EQ(read_number(at, end, value), at) << "x";
  at = read_number(at + 1, end, value);
  EXPECT_TRUE(std::isnan(value));
  at = read_number(at, end, value);
  EXPECT_EQ(value, -HUGE_VAL);
  at = read_number(at, end, value);
  EXPECT_EQ(value, 1);
  EXPECT_EQ(*at, ',');
  at += 2;
  EXPECT_EQ(read_number(at, end, value), at) << "+-1";
  at += 4;
  EXPECT_EQ(read_number(at, end, value), at) << "1e999";
}

TEST(NumberText, KnowsNoLocale) {
  LIVECAP_COMMA_LOCALE_OR_SKIP(commas);
  EXPECT_EQ(format("%.2f", 1.5), "1,50");
  EXPECT_EQ(fixed_text(1234.5, 2), "1234.50");
  EXPECT_EQ(general_text(0.25, 6), "0.25");
  const std::string text = "1.5";
  double value = 0;
  EXPECT_EQ(read_number(text.data(), text.data() + text.size(), value), text.data() + text.size());
  EXPECT_EQ(value, 1.5);
}

}  // namespace
}  // namespace livecap
