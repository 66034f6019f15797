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

}  // namespace
}  // namespace livecap
