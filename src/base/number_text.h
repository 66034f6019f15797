// Numbers in files: with a decimal point whatever locale the program that calls this library has set. format() writes
// as that locale does, and is for messages.
#pragma once

#include <string>

namespace livecap {

// As "%.*f".
std::string fixed_text(double value, int decimals);

// As "%.*g".
std::string general_text(double value, int digits);

// The number, "inf" or "nan" in front of `end`, behind spaces and perhaps a plus. Returns where it ends; `begin` when
// there is none, or none that a double can hold.
const char* read_number(const char* begin, const char* end, double& value);

}  // namespace livecap
