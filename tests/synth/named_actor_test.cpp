#include "synth/named_actor.h"

#include <gtest/gtest.h>

#include "livecap/error.h"

namespace livecap {
namespace {

TEST(NamedActor, BuiltinOnesHaveAPrefix) {
  EXPECT_TRUE(is_builtin_actor("builtin:skirt"));
  EXPECT_FALSE(is_builtin_actor("actors/builtin:skirt"));
  EXPECT_FALSE(is_builtin_actor("skirt"));
  EXPECT_EQ(builtin_actor_name("builtin:skirt"), "skirt");
  EXPECT_EQ(builtin_actor_name("builtin:"), "");
}

TEST(NamedActor, OfAFileTheValidNamesAreTold) {
  try {
    builtin_actor_name("actor.glb");
    FAIL() << "accepted";
  } catch (const ConfigError& e) {
    EXPECT_STREQ(e.what(), "--actor actor.glb: expected builtin:skirt or builtin:trousers");
  }
}

}  // namespace
}  // namespace livecap
