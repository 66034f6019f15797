#include "value_checks.h"

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <functional>

#include "base/text.h"

namespace livecap::tools {
namespace {

// rule: what stands after "must be".
CLI::Validator number_check(const std::string& rule, const std::function<bool(double)>& fits) {
  const auto check = [rule, fits](const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0') return "must be a number, not " + text;
    return fits(value) ? std::string() : "must be " + rule + ", not " + text;
  };
  return CLI::Validator(check, rule);
}

}  // namespace

CLI::Validator not_empty() {
  return CLI::Validator([](const std::string& text) { return text.empty() ? "must not be empty" : ""; }, "");
}

CLI::Validator whole_number() {
  const std::string rule = "whole number from 0 to 18446744073709551615";
  return CLI::Validator(
      [rule](const std::string& text) {
        uint64_t value = 0;
        const char* end = text.data() + text.size();
        const auto [at, error] = std::from_chars(text.data(), end, value);
        return error == std::errc() && at == end ? std::string() : "must be a " + rule + ", not " + text;
      },
      "");
}

CLI::Validator above(double bound) {
  return number_check(format("above %g", bound), [bound](double value) { return value > bound; });
}

CLI::Validator at_least(double least) {
  return number_check(format("at least %g", least), [least](double value) { return value >= least; });
}

CLI::Validator between(const ValueRange& range, const std::string& unit) {
  return number_check(format("between %g and %g", range.least, range.most) + (unit.empty() ? "" : " " + unit),
                      [range](double value) { return range.contains(value); });
}

}  // namespace livecap::tools
