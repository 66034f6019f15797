// The subcommands of `livecap actor` that have files of their own.
#pragma once

#include "command.h"

namespace livecap::tools {

void add_actor_build_command(CLI::App& actor, Action& action);
void add_actor_views_command(CLI::App& actor, Action& action);
void add_actor_fit_command(CLI::App& actor, Action& action);

}  // namespace livecap::tools
