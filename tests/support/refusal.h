// What is refused, and whether the message says why.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace livecap::test {

// action() throws E, whose message has all of the words.
template <typename E, typename Action>
void expect_refused(Action&& action, const std::vector<std::string>& words) {
  try {
    action();
    FAIL() << words.front() << " was accepted";
  } catch (const E& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " is not in: " << error.what();
  }
}

}  // namespace livecap::test
