// What the library says while it works, and where: log lines, to standard error unless a program wants them elsewhere.
// Process-wide, because the terminal is.
#pragma once

#include <functional>
#include <string>

namespace livecap {

enum class LogLevel { kError = 0, kWarning = 1, kInfo = 2, kDebug = 3 };

// Default: kWarning.
void set_log_level(LogLevel level);
LogLevel log_level();

// Called with each line of the level or below, without its end, by whichever thread has something to say, one at a
// time. It must call nothing of the library.
using LogSink = std::function<void(LogLevel, const std::string&)>;

// Empty: standard error again. Once this has returned the one before is not called any more.
void set_log_sink(LogSink sink);

}  // namespace livecap
