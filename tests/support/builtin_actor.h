// The built-in actors, loaded once a program.
#pragma once

#include <map>
#include <string>

#include "actor/actor.h"
#include "synth/synth.h"

namespace livecap::test {

inline const Actor& builtin_actor(const std::string& name) {
  static std::map<std::string, Actor> actors;
  auto found = actors.find(name);
  if (found == actors.end()) found = actors.emplace(name, load_actor_bytes(make_builtin_actor_glb(name), name)).first;
  return found->second;
}

}  // namespace livecap::test
