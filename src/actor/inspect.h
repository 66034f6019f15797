// What `livecap actor inspect FILE` prints.
#pragma once

#include <string>

#include "actor/actor.h"

namespace livecap {

// Counts, size, bones, joint angles with rest and limits, labels, keypoints and every note, as lines of text.
std::string inspect_actor(const Actor& actor);

}  // namespace livecap
