// Actors that are named instead of kept in a file: "builtin:skirt".
#pragma once

#include <string>

namespace livecap {

// False: `actor` is a file.
bool is_builtin_actor(const std::string& actor);

// "skirt" of "builtin:skirt"; whether there is such an actor is not asked. Throws ConfigError for a file.
std::string builtin_actor_name(const std::string& actor);

}  // namespace livecap
