#include "capture/tracker_options.h"

#include <cmath>
#include <string>
#include <utility>

#include "base/text.h"
#include "livecap/error.h"
#include "match/layout.h"
#include "shared/exact_sum.h"

namespace livecap {
namespace {

constexpr double kMostGuessedFactor = 100;
constexpr double kMostLeanRad = 1.5;

void require(bool ok, const char* field, double value, const std::string& range) {
  if (!ok) throw ConfigError(format("tracker option %s is %g; it must be %s", field, value, range.c_str()));
}

void not_negative(const char* field, double value) {
  require(value >= 0 && std::isfinite(value), field, value, "finite and not negative");
}

void share(const char* field, double value) {
  require(value >= 0 && value <= 1, field, value, "from 0 to 1");
}

void require_levels(const char* field, const std::vector<int>& levels) {
  for (int level : levels)
    require(level >= 0 && level <= LC_MATCH_LEVELS, field, level, format("in 0..%d", LC_MATCH_LEVELS));
}

void factor_of_guessed(const char* field, double value) {
  require(value > 0 && value <= kMostGuessedFactor, field, value, format("above 0 and at most %g", kMostGuessedFactor));
}

}  // namespace

void PoseSharesOptions::validate() const {
  not_negative("shares.min_matched_rigidity", min_matched_rigidity);
  not_negative("shares.max_matched_leg_weight", max_matched_leg_weight);
  share("shares.refined_hanging_share", refined_hanging_share);
  for (const auto& [field, value] :
       {std::pair{"shares.foot_share", foot_share}, {"shares.rough_foot_share", rough_foot_share}})
    require(value >= 1 && value <= LC_EXACT_MOST_SHARE, field, value, format("from 1 to %d", LC_EXACT_MOST_SHARE));
}

void PoseRoundsOptions::validate() const {
  require_levels("rounds.match_levels", match_levels);
  not_negative("rounds.refining_rounds", refining_rounds);
  not_negative("rounds.settled_round_px", settled_round_px);
  not_negative("rounds.settled_step_px", settled_step_px);
  not_negative("rounds.settled_last_step_px", settled_last_step_px);
  require(matched_3d > 0 && matched_3d <= 1, "rounds.matched_3d", matched_3d, "above 0 and at most 1");
  share("rounds.refined_arms_3d", refined_arms_3d);
  not_negative("rounds.refined_doubt_3d_mm", refined_doubt_3d_mm);
  share("rounds.on_feet_legs_3d", on_feet_legs_3d);
  share("rounds.free_legs_3d", free_legs_3d);
  not_negative("rounds.missed_px", missed_px);
}

void GuessedWeightsOptions::validate() const {
  factor_of_guessed("guessed.keypoint_2d", keypoint_2d);
  factor_of_guessed("guessed.silhouette", silhouette);
  factor_of_guessed("guessed.shading", shading);
  share("guessed.blur", blur);
}

void HiddenKneesOptions::validate() const {
  not_negative("hidden_knees.least_cover_mm", least_cover_mm);
  share("hidden_knees.keypoint_2d", keypoint_2d);
  not_negative("hidden_knees.refined_doubt_3d_mm", refined_doubt_3d_mm);
  share("hidden_knees.least_stands", least_stands);
  share("hidden_knees.balance_share", balance_share);
}

void OtherStartsOptions::validate() const {
  for (double lean : leans_rad)
    require(std::abs(lean) <= kMostLeanRad, "starts.leans_rad", lean, format("at most %g either way", kMostLeanRad));
  not_negative("starts.least_turn_rad", least_turn_rad);
  not_negative("starts.least_twist_rad", least_twist_rad);
  not_negative("starts.least_found_twist_rad", least_found_twist_rad);
  not_negative("starts.cost_of_imbalance", cost_of_imbalance);
  not_negative("starts.on_edge_rad", on_edge_rad);
  not_negative("starts.strayed_share", strayed_share);
  not_negative("starts.strayed_arm_share", strayed_arm_share);
  not_negative("starts.strayed_arm_depth_mm", strayed_arm_depth_mm);
  not_negative("starts.cost_of_covering", cost_of_covering);
  not_negative("starts.least_mirrored_rad", least_mirrored_rad);
  not_negative("starts.mirrored_misfit", mirrored_misfit);
  not_negative("starts.max_exchanged_frames", max_exchanged_frames);
  not_negative("starts.on_edge_frames", on_edge_frames);
  require(twisted_frames >= 1, "starts.twisted_frames", twisted_frames, "at least 1");
}

void TrackerOptions::validate() const {
  shares.validate();
  rounds.validate();
  drape.validate();
  guessed.validate();
  hidden_knees.validate();
  starts.validate();
  actor_light.validate();
  not_negative("max_carried_rigidity", max_carried_rigidity);
  share("worn_carried_share", worn_carried_share);
  share("taut_carried_share", taut_carried_share);
  share("loose_carried_share", loose_carried_share);
  share("behind_share", behind_share);
  share("anew_share", anew_share);
  require_levels("cloth_match_levels", cloth_match_levels);
  if (cloth_match_levels.size() > surface.gaussian_kernels.size())
    throw ConfigError(format("tracker option cloth_match_levels has %zu levels; surface.gaussian_kernels has %zu",
                             cloth_match_levels.size(), surface.gaussian_kernels.size()));
  not_negative("lost_error_fraction", lost_error_fraction);
  not_negative("max_doubtful_frames", max_doubtful_frames);
  not_negative("max_missed_frames", max_missed_frames);
  share("least_missed_iou", least_missed_iou);
  share("least_found_iou", least_found_iou);
}

}  // namespace livecap
