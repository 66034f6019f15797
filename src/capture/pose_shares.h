// What of an actor stage I matches, and how much of it counts: shares of the weight of each vertex's match; and what
// counts otherwise where its skinning weights are guessed, its shape is rough or cloth hides its knees.
#pragma once

#include <cstdint>
#include <vector>

#include "actor/actor.h"
#include "capture/tracker_options.h"

namespace livecap {

// [n_vertices] 1 for vertices that are matched, else 0.
std::vector<float> matched_share(const Actor& actor, const PoseSharesOptions& options,
                                 const HangingClothOptions& hanging);
std::vector<uint8_t> is_matched(const Actor& actor, const PoseSharesOptions& options,
                                const HangingClothOptions& hanging);
// The same in refining rounds: less for hanging cloth.
std::vector<float> refined_share(const Actor& actor, const PoseSharesOptions& options,
                                 const HangingClothOptions& hanging);
// And where no starts compete: more for feet.
std::vector<float> on_feet_share(const Actor& actor, const PoseSharesOptions& options,
                                 const HangingClothOptions& hanging);

// How far a skirt or dress reaches below the knees in the rest pose, mm; negative above them, or where there is none.
double knee_cover_mm(const Actor& actor);

// As both stages have them for this actor: see GuessedWeightsOptions, HiddenKneesOptions and
// PoseSharesOptions::rough_foot_share.
TrackerOptions options_for(const Actor& actor, TrackerOptions options);

}  // namespace livecap
