// What disturbs a sequence, so that robustness can be tested with truth at hand: who walks where, which light moves,
// which frames are missing. See SynthOptions::scenario.
#pragma once

#include <optional>
#include <string>

#include "synth/motion.h"
#include "synth/renderer.h"
#include "synth/synth.h"

namespace livecap::synth {

enum class Scenario { kNone, kLeave, kTwoPeople, kMovingShadow, kSimilarBackground, kGap };

// Throws ConfigError naming the known ones.
Scenario scenario_from_name(const std::string& name);

// All times are seconds since the first person's first frame; `out_mm` is how far to the side nothing of a person is
// in the picture any more.

// kLeave: walks out of the picture to the right, stays away, comes back.
void leave_and_return(double t, double out_mm, Posture& posture);

// kTwoPeople: walks through the picture from left to right, behind the first person; nothing while not in it.
inline constexpr double kPasserByZ = -700;  // mm, room frame
std::optional<Posture> passer_by(double t, double out_mm, const Posture& walking);

// kMovingShadow: somebody outside the picture walks to and fro between the lamp and the room.
MovingShadow moving_shadow(double t);

// kGap: the last frames of every second are missing.
bool is_left_out(double t);

// kSimilarBackground: the mean colours of the actor's clothes.
Wallpaper clothes_wallpaper(const ActorModel& actor);

}  // namespace livecap::synth
