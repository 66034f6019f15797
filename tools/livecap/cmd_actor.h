// The subcommands of `livecap actor` that have files of their own.
#pragma once

#include <string>
#include <vector>

#include "base/require_apart.h"
#include "command.h"

namespace livecap::tools {

// Of --out of `build`, `fit` and `import`: NAME.glb, and NAME.html with the report beside it. Throws ConfigError or
// IoError, before any work, where it is called otherwise, cannot be written or is one of the inputs.
void require_actor_output(const std::string& out, const std::vector<InputFile>& inputs);

// --unit of cameras whose unit is known.
void add_camera_unit_option(CLI::App& command, std::string& unit);

void add_actor_build_command(CLI::App& actor, Action& action);
void add_actor_views_command(CLI::App& actor, Action& action);
void add_actor_import_command(CLI::App& actor, Action& action);
void add_actor_fit_command(CLI::App& actor, Action& action);

}  // namespace livecap::tools
