#include "base/value_range.h"

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

void require_within(const std::string& option, double value, const ValueRange& range, const std::string& unit) {
  if (range.contains(value)) return;
  throw ConfigError(format("%s %g: must be between %g and %g%s", option.c_str(), value, range.least, range.most,
                           (unit.empty() ? "" : " " + unit).c_str()));
}

}  // namespace livecap
