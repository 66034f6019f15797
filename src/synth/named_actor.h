// Actors that are named instead of kept in a file: "builtin:skirt".
#pragma once

#include <string>

namespace livecap {

// False: `actor` is a file.
bool is_builtin_actor(const std::string& actor);

// "skirt" of "builtin:skirt"; whether there is such an actor is not asked. Throws ConfigError for a file.
std::string builtin_actor_name(const std::string& actor);

// The bytes of the file, or of the built-in actor made height_mm tall (0: kBuiltinHeightMm). Throws IoError,
// ConfigError (see read_file, make_builtin_actor_glb).
std::string named_actor_glb(const std::string& actor, double height_mm);

}  // namespace livecap
