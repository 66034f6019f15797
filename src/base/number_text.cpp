#include "base/number_text.h"

#include <charconv>
#include <limits>

namespace livecap {
namespace {

std::string number_text(double value, std::chars_format form, int precision) {
  std::string text(std::numeric_limits<double>::max_exponent10 + 20 + precision, '\0');
  text.resize(std::to_chars(text.data(), text.data() + text.size(), value, form, precision).ptr - text.data());
  return text;
}

}  // namespace

std::string fixed_text(double value, int decimals) {
  return number_text(value, std::chars_format::fixed, decimals);
}

std::string general_text(double value, int digits) {
  return number_text(value, std::chars_format::general, digits);
}

const char* read_number(const char* begin, const char* end, double& value) {
  const char* at = begin;
  while (at != end && (*at == ' ' || (*at >= '\t' && *at <= '\r'))) ++at;
  if (at != end && *at == '+' && at + 1 != end && at[1] != '-') ++at;
  const auto [behind, error] = std::from_chars(at, end, value);
  return error == std::errc() ? behind : begin;
}

}  // namespace livecap
