// Log lines to standard error. The level is process-wide because the terminal is.
#pragma once

#include <string>

namespace livecap {

enum class LogLevel { kError = 0, kWarning = 1, kInfo = 2, kDebug = 3 };

// Default: kWarning.
void set_log_level(LogLevel level);
LogLevel log_level();

void log_error(const std::string& message);
void log_warning(const std::string& message);
void log_info(const std::string& message);
void log_debug(const std::string& message);

}  // namespace livecap
