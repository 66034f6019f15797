// Log lines go where a program wants them.
#include "base/log.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace livecap {
namespace {

TEST(Log, LinesOfTheLevelAndBelowGoToTheSink) {
  const LogLevel before = log_level();
  std::vector<std::pair<LogLevel, std::string>> lines;
  set_log_sink([&](LogLevel level, const std::string& line) { lines.emplace_back(level, line); });
  set_log_level(LogLevel::kInfo);
  log_error("no device");
  log_debug("not this");
  log_info("a look");
  set_log_level(before);
  set_log_sink({});
  testing::internal::CaptureStderr();
  log_error("to the terminal");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "error: to the terminal\n");
  const std::vector<std::pair<LogLevel, std::string>> expected = {{LogLevel::kError, "no device"},
                                                                  {LogLevel::kInfo, "a look"}};
  EXPECT_EQ(lines, expected);
}

// Names come from files, and a terminal takes some bytes of them as orders.
TEST(Log, LinesTellATerminalNothingButLetters) {
  testing::internal::CaptureStderr();
  log_error("bone \"a\x1b[2J\r\xc2\x9b\":\n  kernel.cl:1\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "error: bone \"a?[2J??\":\n  kernel.cl:1\n\n");
}

}  // namespace
}  // namespace livecap
