#include "synth/named_actor.h"

#include <mutex>

#include "base/text.h"
#include "livecap/error.h"
#include "synth/synth.h"

namespace livecap {
namespace {

const std::string kPrefix = "builtin:";

struct Figure {
  std::string name;
  double height_mm = 0;
  bool operator==(const Figure&) const = default;
};

}  // namespace

bool is_builtin_actor(const std::string& actor) {
  return actor.rfind(kPrefix, 0) == 0;
}

std::string builtin_actor_name(const std::string& actor) {
  if (is_builtin_actor(actor)) return actor.substr(kPrefix.size());
  std::string names;
  for (const std::string& name : builtin_actor_names()) names += (names.empty() ? "" : " or ") + kPrefix + name;
  throw ConfigError("--actor " + actor + ": expected " + names);
}

std::string named_actor_glb(const std::string& actor, double height_mm) {
  if (!is_builtin_actor(actor)) return read_file(actor);
  const Figure wanted{builtin_actor_name(actor), height_mm > 0 ? height_mm : kBuiltinHeightMm};
  // Making one takes seconds, and an ablation asks for the same one forty times: the last is kept.
  static std::mutex mutex;
  static Figure kept;
  static std::string glb;
  const std::lock_guard lock(mutex);
  if (kept != wanted) {
    glb = make_builtin_actor_glb(wanted.name, wanted.height_mm);
    kept = wanted;
  }
  return glb;
}

}  // namespace livecap
