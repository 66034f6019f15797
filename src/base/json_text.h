// JSON as text, whatever the bytes of its strings: names of files need not be UTF-8, which JSON has to be.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace livecap {

// What is no UTF-8 becomes U+FFFD. indent: spaces a level; -1: everything in one line.
template <typename Json>
std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace livecap
