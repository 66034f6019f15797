#include "base/log.h"

#include <atomic>
#include <cstdio>
#include <mutex>
#include <utility>

namespace livecap {
namespace {

std::atomic<LogLevel> g_level{LogLevel::kWarning};
std::mutex g_mutex;
LogSink g_sink;

void write(LogLevel level, const char* prefix, const std::string& message) {
  if (level > g_level.load()) return;
  const std::lock_guard lock(g_mutex);  // held during the call, so that nobody calls a sink that was replaced
  if (g_sink) return g_sink(level, message);
  std::fprintf(stderr, "%s%s\n", prefix, message.c_str());
}

}  // namespace

void set_log_level(LogLevel level) {
  g_level = level;
}
LogLevel log_level() {
  return g_level;
}

void set_log_sink(LogSink sink) {
  const std::lock_guard lock(g_mutex);
  g_sink = std::move(sink);
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
