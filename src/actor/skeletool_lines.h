// The lines of a Skeletool text file, split at white space. Private to the actor room.
#pragma once

#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

class SkeletoolLines {
 public:
  // Reads the file and checks its first line. Throws IoError.
  SkeletoolLines(const std::filesystem::path& path, const std::string& header)
      : name_(path.string()), in_(read_file(path)) {
    std::string line;
    std::getline(in_, line);
    number_ = 1;
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (line != header) fail("does not begin with \"" + header + "\"");
  }

  // Next line that is not empty; false at the end.
  bool next() {
    for (std::string line; std::getline(in_, line);) {
      ++number_;
      std::istringstream text(line);
      words_.clear();
      for (std::string word; text >> word;) words_.push_back(word);
      if (!words_.empty()) return true;
    }
    words_.clear();
    return false;
  }
  void require(const std::string& expected) {
    if (!next()) fail("the file ends where " + expected + " was expected");
  }
  // "WORD: N" on the next line.
  int section(const std::string& title) {
    require("\"" + title + ": N\"");
    std::string found;
    for (size_t i = 0; i + 1 < words_.size(); ++i) found += (i ? " " : "") + words_[i];
    if (found != title + ":") fail("expected \"" + title + ": N\"");
    return integer(words_.size() - 1);
  }

  [[noreturn]] void fail(const std::string& what) const { throw IoError(name_ + format(":%d: ", number_) + what); }

  size_t size() const { return words_.size(); }
  const std::string& word(size_t i) const { return words_[i]; }
  int integer(size_t i) const {
    int value = 0;
    const std::string& w = words_[i];
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (error != std::errc() || end != w.data() + w.size() || value < 0) fail("\"" + w + "\" is not a count or index");
    return value;
  }
  // Millimetres, radians and weights, and their products, stay far from what a double cannot hold.
  double number(size_t i) const {
    constexpr double kLargest = 1e9;
    double value = 0;
    const std::string& w = words_[i];
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (error != std::errc() || end != w.data() + w.size()) fail("\"" + w + "\" is not a number");
    if (!(std::abs(value) <= kLargest)) fail("\"" + w + format("\" must be a number within %g", kLargest));
    return value;
  }

 private:
  std::string name_;
  std::istringstream in_;
  int number_ = 0;
  std::vector<std::string> words_;
};

}  // namespace livecap
