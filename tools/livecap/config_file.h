// --config FILE.toml: every long option of a subcommand as `name = value`, either in a section [subcommand] (for
// `actor build` it is [actor.build]) or at the top of the file. What the command line says wins. Sections of other
// subcommands are left alone, an unknown name is an error.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace livecap::tools {

// Adds --config to the program; to be called before parsing. Parsing then throws ConfigError for a file that is not
// what it has to be, with file and line.
void add_config_option(CLI::App& app);

// "FILE:LINE: " of an option that the file gave; empty for others.
std::string place_in_config(const CLI::App& app, const CLI::Option& option);

}  // namespace livecap::tools
