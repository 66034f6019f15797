#include "base/log.h"

#include <atomic>
#include <cstdio>

namespace livecap {
namespace {

std::atomic<LogLevel> g_level{LogLevel::kWarning};

void write(LogLevel level, const char* prefix, const std::string& message) {
  if (level > g_level.load()) return;
  std::fprintf(stderr, "%s%s\n", prefix, message.c_str());
}

}  // namespace

void set_log_level(LogLevel level) {
  g_level = level;
}
LogLevel log_level() {
  return g_level;
}

void log_error(const std::string& message) {
  write(LogLevel::kError, "error: ", message);
}
void log_warning(const std::string& message) {
  write(LogLevel::kWarning, "warning: ", message);
}
void log_info(const std::string& message) {
  write(LogLevel::kInfo, "", message);
}
void log_debug(const std::string& message) {
  write(LogLevel::kDebug, "debug: ", message);
}

}  // namespace livecap
