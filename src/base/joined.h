// Names for messages and help texts.
#pragma once

#include <string>
#include <vector>

namespace livecap {

// Separated by a comma and a space.
inline std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace livecap
