#include "capture/pose_shares.h"

#include <algorithm>
#include <limits>

#include "actor/labels.h"
#include "cloth/hanging_cloth.h"
#include "pose/targets.h"

namespace livecap {
namespace {

// Of the vertices, so few are wrong labels.
constexpr double kFewHanging = 0.02;
constexpr size_t kPerStray = 50;  // of a skirt's vertices, one in so many may be lower than the hem

bool wears_hanging_cloth(const Actor& actor) {
  int n = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) n += hangs(actor, i);
  return n > kFewHanging * actor.n_vertices();
}

}  // namespace

std::vector<float> matched_share(const Actor& actor, const PoseSharesOptions& options,
                                 const HangingClothOptions& hanging) {
  const std::vector<float> legs = trusted_leg_weights(actor, hanging);
  std::vector<float> share(actor.n_vertices());
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const bool follows = actor.rigidity[i] >= options.min_matched_rigidity || legs[i] < options.max_matched_leg_weight;
    share[i] = follows ? 1.0f : 0.0f;
  }
  return share;
}

std::vector<uint8_t> is_matched(const Actor& actor, const PoseSharesOptions& options,
                                const HangingClothOptions& hanging) {
  const std::vector<float> share = matched_share(actor, options, hanging);
  return {share.begin(), share.end()};
}

std::vector<float> refined_share(const Actor& actor, const PoseSharesOptions& options,
                                 const HangingClothOptions& hanging) {
  std::vector<float> share = matched_share(actor, options, hanging);
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i)) share[i] *= options.refined_hanging_share;
  return share;
}

std::vector<float> on_feet_share(const Actor& actor, const PoseSharesOptions& options,
                                 const HangingClothOptions& hanging) {
  std::vector<float> share = refined_share(actor, options, hanging);
  const int left_foot = actor.skeleton.bone_index("left_ankle"), right_foot = actor.skeleton.bone_index("right_ankle");
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const int strongest = actor.skin.bones[4 * i];
    if (strongest == left_foot || strongest == right_foot) share[i] *= options.foot_share;
  }
  return share;
}

double knee_cover_mm(const Actor& actor) {
  const double none = -std::numeric_limits<double>::infinity();
  if (!wears_hanging_cloth(actor)) return none;
  for (int k : {kLeftKnee, kRightKnee})
    if (actor.keypoints[k].bone < 0) return none;
  std::vector<float> heights;
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (actor.labels[i] == lip::kSkirt || actor.labels[i] == lip::kDress)
      heights.push_back(actor.mesh.positions[3 * i + 1]);
  if (heights.empty()) return none;
  const auto hem = heights.begin() + heights.size() / kPerStray;
  std::nth_element(heights.begin(), hem, heights.end());
  const auto rest = keypoint_positions(actor, forward_kinematics(actor.skeleton, rest_pose(actor.skeleton)));
  return std::min(rest[kLeftKnee].y(), rest[kRightKnee].y()) - *hem;
}

TrackerOptions options_for(const Actor& actor, TrackerOptions options) {
  if (actor.rough_shape) options.shares.foot_share = options.shares.rough_foot_share;
  if (knee_cover_mm(actor) >= options.hidden_knees.least_cover_mm) {
    for (int k : {kLeftKnee, kRightKnee}) options.pose.keypoint_2d_weights[k] *= options.hidden_knees.keypoint_2d;
    options.pose.least_stands = std::max(options.pose.least_stands, options.hidden_knees.least_stands);
    BalanceOptions& balance = options.floor.balance;
    if (balance.share > 0) balance.share = std::max(balance.share, options.hidden_knees.balance_share);
    double& doubt_mm = options.rounds.refined_doubt_3d_mm;
    if (doubt_mm > 0) doubt_mm = options.hidden_knees.refined_doubt_3d_mm;
  }
  if (!actor.guessed_weights) return options;
  options.match.blur = options.guessed.blur;
  options.pose.weights.shading *= options.guessed.shading;
  if (wears_hanging_cloth(actor)) return options;
  options.pose.weights.keypoint_2d *= options.guessed.keypoint_2d;
  options.pose.weights.silhouette *= options.guessed.silhouette;
  return options;
}

}  // namespace livecap
