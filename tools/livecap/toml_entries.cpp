#include "toml_entries.h"

#include <toml++/toml.h>

#include <array>
#include <charconv>
#include <optional>

#include "livecap/error.h"

namespace livecap::tools {
namespace {

// Nothing of a date or a table.
std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  if (const auto* number = node.as_floating_point()) {
    std::array<char, 32> digits;  // the fewest that mean the same number
    return std::string(digits.data(), std::to_chars(digits.begin(), digits.end(), number->get()).ptr);
  }
  return std::nullopt;
}

std::optional<std::vector<std::string>> texts_of(const toml::node& node) {
  std::vector<std::string> texts;
  const auto add = [&](const toml::node& value) {
    const std::optional<std::string> text = text_of(value);
    if (text) texts.push_back(*text);
    return text.has_value();
  };
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& value : *array)
      if (!add(value)) return std::nullopt;
  } else if (!add(node)) {
    return std::nullopt;
  }
  return texts;
}

std::string place(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line) + ": ";
}

void add_entries(const toml::table& table, std::vector<std::string>& section, const std::string& file,
                 std::vector<TomlEntry>& entries) {
  for (const auto& [key, node] : table) {
    if (const toml::table* below = node.as_table()) {
      section.emplace_back(key.str());
      add_entries(*below, section, file, entries);
      section.pop_back();
      continue;
    }
    const std::optional<std::vector<std::string>> values = texts_of(node);
    if (!values)
      throw ConfigError(place(file, key.source()) + one_line(std::string(key.str()), 60) +
                        " must be a string, a number, true, false or an array of these");
    entries.push_back({section, std::string(key.str()), *values, static_cast<int>(key.source().begin.line)});
  }
}

}  // namespace

std::vector<TomlEntry> read_toml(const std::string& text, const std::string& file) {
  std::vector<TomlEntry> entries;
  std::vector<std::string> section;
  try {
    add_entries(toml::parse(text), section, file, entries);
  } catch (const toml::parse_error& error) {
    throw ConfigError(place(file, error.source()) + one_line(std::string(error.description())) +
                      " (TOML: name = value, text in quotes)");
  }
  return entries;
}

}  // namespace livecap::tools
