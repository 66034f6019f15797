#include "base/log.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <string_view>
#include <utility>

#include "livecap/error.h"

namespace livecap {
namespace {

std::atomic<LogLevel> g_level{LogLevel::kWarning};
std::mutex g_mutex;
LogSink g_sink;

// Messages hold names that come from files; a build log has several lines.
std::string lines_of(std::string_view message) {
  std::string lines;
  for (size_t begin = 0; begin <= message.size();) {
    const size_t end = std::min(message.find('\n', begin), message.size());
    lines.append(begin > 0 ? "\n" : "").append(one_line(message.substr(begin, end - begin)));
    begin = end + 1;
  }
  return lines;
}

void write(LogLevel level, const char* prefix, const std::string& message) {
  if (level > g_level.load()) return;
  const std::string lines = lines_of(message);
  const std::lock_guard lock(g_mutex);  // held during the call, so that nobody calls a sink that was replaced
  if (g_sink) return g_sink(level, lines);
  std::fprintf(stderr, "%s%s\n", prefix, lines.c_str());
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
