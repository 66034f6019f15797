// --config FILE.toml: every long option of a subcommand as `name = value`, either in a section [subcommand] or at the
// top of the file. What the command line says wins. Sections of other subcommands are left alone, an unknown name is an
// error.
#pragma once

#include <CLI/CLI.hpp>

namespace livecap::tools {

// Adds --config to the program; to be called before parsing.
void add_config_option(CLI::App& app);

}  // namespace livecap::tools
