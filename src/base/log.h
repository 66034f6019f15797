// How the rooms write log lines; where they go is livecap/log.h.
#pragma once

#include <string>

#include "livecap/log.h"

namespace livecap {

void log_error(const std::string& message);
void log_warning(const std::string& message);
void log_info(const std::string& message);
void log_debug(const std::string& message);

}  // namespace livecap
