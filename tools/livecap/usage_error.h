// What is wrong with a command line, in the words of this program. (CLI11 says "A subcommand is required" where one is
// misspelt, a required option is missing where its name is misspelt, and nothing of what a value should be.)
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace livecap::tools {

// What stands where a subcommand has to, and is none; empty: nothing of the kind.
std::string unknown_subcommand(const CLI::App& app);

// One line: the argument, what would be right, and whose --help says more. error: what app.parse() threw.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

}  // namespace livecap::tools
