#include "toml_lines.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <sstream>

#include "livecap/error.h"

namespace livecap::tools {
namespace {

std::string trimmed(const std::string& text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if_not(text.rbegin(), std::make_reverse_iterator(begin), is_space).base();
  return {begin, end};
}

bool is_name(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
}

// Up to a # outside quotes.
std::string without_comment(const std::string& line) {
  char quote = '\0';
  for (size_t i = 0; i < line.size(); ++i) {
    if (quote) {
      if (line[i] == quote) quote = '\0';
    } else if (line[i] == '"' || line[i] == '\'') {
      quote = line[i];
    } else if (line[i] == '#') {
      return line.substr(0, i);
    }
  }
  return line;
}

// At the dots; nothing when a part is no name.
std::optional<std::vector<std::string>> section_path(const std::string& text) {
  std::vector<std::string> path;
  std::istringstream parts(text + ".");
  for (std::string part; std::getline(parts, part, '.');) {
    path.push_back(trimmed(part));
    if (!is_name(path.back())) return std::nullopt;
  }
  return path;
}

// A string without its quotes, a number or a word; nothing when it is neither.
std::optional<std::string> plain_value(const std::string& text) {
  if (text.empty()) return std::nullopt;
  if (text[0] == '"' || text[0] == '\'') {
    if (text.size() < 2 || text.find(text[0], 1) != text.size() - 1) return std::nullopt;
    return text.substr(1, text.size() - 2);
  }
  if (text.find_first_of("[]{}\"'=, \t") != std::string::npos) return std::nullopt;
  return text;
}

// Items of "[a, b]", split at commas outside quotes; nothing when one is no value.
std::optional<std::vector<std::string>> array_values(const std::string& text) {
  std::vector<std::string> values;
  std::string item;
  char quote = '\0';
  for (char c : text.substr(1, text.size() - 2) + ",") {
    if (quote ? c == quote : c == '"' || c == '\'') quote = quote ? '\0' : c;
    if (c != ',' || quote) {
      item += c;
      continue;
    }
    const std::string value = trimmed(item);
    item.clear();
    if (value.empty()) continue;  // after the last comma
    const std::optional<std::string> plain = plain_value(value);
    if (!plain) return std::nullopt;
    values.push_back(*plain);
  }
  if (quote) return std::nullopt;
  return values;
}

}  // namespace

std::vector<TomlEntry> read_toml(const std::string& text, const std::string& file) {
  std::vector<TomlEntry> entries;
  std::vector<std::string> section;
  std::istringstream lines(text);
  int number = 0;
  for (std::string raw; std::getline(lines, raw);) {
    const int begun = ++number;
    const auto fail = [&](const std::string& expected) {
      throw ConfigError(file + ":" + std::to_string(begun) + ": expected " + expected + ", found " +
                        one_line(trimmed(raw), 60));
    };
    std::string line = trimmed(without_comment(raw));
    if (line.empty()) continue;
    if (line.front() == '[') {
      const auto path = line.back() == ']' ? section_path(line.substr(1, line.size() - 2)) : std::nullopt;
      if (!path) fail("[SUBCOMMAND] such as [capture] or [actor.build]");
      section = *path;
      continue;
    }
    const size_t equals = line.find('=');
    const auto name = plain_value(trimmed(line.substr(0, equals)));  // may be in quotes
    if (equals == std::string::npos || !name || !is_name(*name)) fail("name = value or [SUBCOMMAND]");
    TomlEntry entry = {section, *name, {}, begun};
    std::string value = trimmed(line.substr(equals + 1));
    if (!value.empty() && value.front() == '[') {
      for (std::string more; value.back() != ']' && std::getline(lines, more); ++number)
        value += trimmed(without_comment(more));
      const auto values = value.size() > 1 && value.back() == ']' ? array_values(value) : std::nullopt;
      if (!values) fail("an array such as [\"photo\", \"cloth\"]");
      entry.values = *values;
    } else {
      const auto plain = plain_value(value);
      if (!plain) fail("a value after =: \"text\" in quotes, a number, true or false");
      entry.values = {*plain};
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace livecap::tools
