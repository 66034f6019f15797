#include "livecap/error.h"

#include <gtest/gtest.h>

namespace livecap {
namespace {

// Names in a message come from files; the program promises one line on a terminal.
TEST(Error, BadInputIsOnePrintableLine) {
  const std::string name = "a.glb: bone \"two\nlines\x1b[2J\t\x7f\" \xc3\xa9";
  const std::string line = "a.glb: bone \"two?lines?[2J??\" \xc3\xa9";
  EXPECT_EQ(IoError(name).what(), line);
  EXPECT_EQ(ConfigError(name).what(), line);
  EXPECT_STREQ(OclError("build log:\nkernel.cl:1").what(), "build log:\nkernel.cl:1");
}

// A terminal may take U+0080 to U+009F, and the bytes of that number, as orders.
TEST(Error, OneLineIsUtf8WithoutOrdersToATerminal) {
  EXPECT_EQ(one_line("\xc2\x9b;2J \xc2\x80\xc2\x9f\xc2\xa0"), "?;2J ??\xc2\xa0");
  EXPECT_EQ(one_line("\x9b;2J \xe9t\xe9"), "?;2J ?t?") << "Latin-1";
  const std::string letters = "\xc3\xa9 \xe2\x82\xac \xf0\x9f\x95\xba \xed\x9f\xbf \xf4\x8f\xbf\xbf";
  EXPECT_EQ(one_line(letters), letters);
  EXPECT_EQ(one_line("\xc0\x8a|\xe0\x82\x9b|\xf0\x8f\xbf\xbf"), "??|???|????") << "longer than they must be";
  EXPECT_EQ(one_line("\xed\xa0\x80|\xf4\x90\x80\x80"), "???|????") << "of no character";
  EXPECT_EQ(one_line("a\xe2\x82"), "a??") << "cut short";
}

TEST(Error, OneLineIsCutBetweenLetters) {
  EXPECT_EQ(one_line("a\xc3\xa9z", 0), "");
  EXPECT_EQ(one_line("a\xc3\xa9z", 2), "a");
  EXPECT_EQ(one_line("a\xc3\xa9z", 3), "a\xc3\xa9");
  EXPECT_EQ(one_line("a\xc3\xa9z", 4), "a\xc3\xa9z");
}

}  // namespace
}  // namespace livecap
