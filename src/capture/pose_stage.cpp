#include "capture/pose_stage.h"

#include <iterator>
#include <optional>
#include <utility>

#include "base/log.h"
#include "capture/pose_shares.h"
#include "pose/held_arms.h"
#include "pose/mirrored_forearm.h"
#include "pose/other_starts.h"
#include "pose/person_height.h"

namespace livecap {

PoseStage::PoseStage(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                     const TrackerOptions& options, DepthRasterizer& rasterizer, SurfaceVisibility& visibility)
    : actor_(actor),
      camera_(camera),
      options_(options_for(actor, (options.validate(), options))),
      rasterizer_(rasterizer),
      floor_(actor, options_.floor, measured_floor(camera)),
      leg_bias_(options.leg_bias),
      rounds_(device, actor, camera, options_, floor_, rasterizer, visibility) {}

void PoseStage::reset() {
  lose_person();
  last_skin_.clear();
  rounds_.skin_shading().forget();
  rounds_.forget_light();
  floor_.forget();
  leg_bias_.forget();
}

void PoseStage::learn(const PoseStageInput& input, const Pose* previous, const Pose& pose) {
  rounds_.skin_shading().learn(last_skin_);
  rounds_.learn_light(input, last_drawn_);
  leg_bias_.learn(actor_, input.detections.keypoints, pose);
  if (!previous || floor_.is_contradicted()) return;
  std::optional<Pose> feet;
  if (!(options_.rounds.free_legs_3d > 0) || !rounds_.counts_feet(input))
    feet = pose;
  else if (floor_.asks_for_feet())
    feet = with_free_legs(input, *previous, pose);
  floor_.learn(*previous, pose, feet ? &*feet : nullptr, input.detections);
  if (floor_.is_contradicted())
    log_warning("feet do not rest on the floor that was given (--camera or --floor); was the camera moved since?");
}

// Where who stands with bent knees is seen with straight ones, feet are found too far away, and a floor learned of them
// holds them there. nullopt where the picture tells nothing that is believed.
std::optional<Pose> PoseStage::with_free_legs(const PoseStageInput& input, const Pose& previous, const Pose& pose) {
  if (exchanged_frames_ > 0) return std::nullopt;
  const Solution freed = rounds_.solve(input, input.detections, pose, &previous, Rounds::kFreeLegs);
  if (!believable(freed.pose, input.detections)) return std::nullopt;
  return freed.pose.pose;
}

// The contour found on a rough pose is only a start: once more from where that solve ends, and from there with the body
// leant by each of leans_rad, with the pelvis turned back, or with other legs. Legs that swing far away from the camera
// may look as well as those that stand below the body.
PoseStage::Solution PoseStage::solve_anew(const PoseStageInput& input, std::span<const double> leans_rad) {
  const std::optional<Pose> initial = initialize_pose(actor_, camera_, input.detections, options_.pose);
  Solution best;
  best.pose.status = SolveStatus::kNoObservations;
  if (!initial) return best;
  best.pose = rounds_.solve_rough(input, *initial);
  if (best.pose.status != SolveStatus::kOk) return best;
  const auto solve_from = [&](const Pose& start) {
    return rounds_.solve(input, input.detections, start, nullptr, Rounds::kAll);
  };
  const auto cost_in_balance = [&](const Solution& solution) {
    const double beyond_100mm = floor_.beyond_balance_mm(solution.pose.pose).value_or(0) / 100;
    return solution.cost * (1 + options_.starts.cost_of_imbalance * beyond_100mm * beyond_100mm);
  };
  const auto try_start = [&](const Pose& start) {
    Solution other = solve_from(start);
    if (other.pose.status != SolveStatus::kOk) return;
    if (best.pose.status != SolveStatus::kOk || cost_in_balance(other) < cost_in_balance(best)) best = std::move(other);
  };
  const Pose rough = best.pose.pose;
  best = solve_from(rough);
  for (double lean_rad : leans_rad) try_start(leant(rough, lean_rad));
  if (!rounds_.matches(input) || best.pose.status != SolveStatus::kOk) return best;
  const auto untwisted = untwisted_pelvis(actor_, best.pose.pose, options_.starts.least_found_twist_rad);
  if (untwisted) try_start(*untwisted);
  for (const Pose& start : with_other_legs(actor_.skeleton, best.pose.pose)) try_start(start);
  return best;
}

// One picture hardly tells how far a body leans towards the camera: who leans is also nearer, so as large. Clothes with
// a pattern match nearly as well from there, and E_temporal then keeps it for a second.
PoseResult PoseStage::find(const PoseStageInput& input) {
  std::span<const double> leans_rad;
  if (rounds_.matches(input)) leans_rad = options_.starts.leans_rad;
  Solution found = solve_anew(input, leans_rad);
  if (found.pose.status == SolveStatus::kOk) last_skin_ = std::move(found.skin);
  last_drawn_ = found.drawn;
  return found.pose;
}

bool PoseStage::believable(const PoseResult& result, const Detections& detections) const {
  if (result.status != SolveStatus::kOk) return false;
  const double height = keypoints_height_px(detections);
  return height > 0 && result.keypoint_error_px < options_.lost_error_fraction * height;
}

PoseResult PoseStage::solve_tracked(const PoseStageInput& input, const Pose& predicted, const Pose& previous) {
  if (!input.detected) return solve_corrected(input, predicted, previous);
  Detections corrected;
  corrected.person = input.detections.person;
  corrected.keypoints = leg_bias_.corrected(input.detections.keypoints, previous);
  return solve_corrected({corrected, input.silhouette, input.frame, true}, predicted, previous);
}

PoseResult PoseStage::solve_corrected(const PoseStageInput& input, const Pose& predicted, const Pose& previous) {
  const std::vector<KeypointDetections> alternatives =
      exchanged_legs(actor_, camera_, predicted, input.detections.keypoints);
  if (alternatives.empty()) exchanged_frames_ = 0;
  const bool on_feet = alternatives.empty() && rounds_.counts_feet(input);
  Solution best =
      rounds_.solve(input, input.detections, predicted, &previous, on_feet ? Rounds::kOnFeet : Rounds::kAll);
  best.is_comparable = !on_feet;
  try_exchanged_legs(input, predicted, previous, alternatives, best);
  try_turned(input, previous, best);
  try_untwisted(input, previous, best);
  try_other_legs(input, previous, best);
  try_detected_legs(input, previous, best);
  try_detected_arms(input, previous, best);
  try_mirrored_forearms(input, previous, best);
  const bool insists = best.exchanged && exchanged_frames_ >= options_.starts.max_exchanged_frames;
  if (insists) try_anew(input, previous, best);
  const bool doubted = input.detected && !believable(best.pose, input.detections);
  if (std::exchange(doubted_, doubted) && doubted && !insists && rounds_.matches(input)) {
    make_comparable(input, previous, best);
    try_anew(input, previous, best);
  }
  if (best.exchanged) ++exchanged_frames_;
  finish(input, previous, best);
  last_skin_ = std::move(best.skin);
  last_drawn_ = best.drawn;
  return best.pose;
}

// Starts are compared where feet count as all else does: legs that are exchanged hold on to the wrong shoes.
void PoseStage::make_comparable(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (std::exchange(best.is_comparable, true)) return;
  Solution other = rounds_.solve(input, input.detections, best.pose.pose, &previous, Rounds::kRefining);
  if (other.pose.status != SolveStatus::kOk) return;
  best = std::move(other);
}

void PoseStage::finish(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!best.is_comparable || !rounds_.counts_feet(input) || best.exchanged) return;
  if (best.pose.status != SolveStatus::kOk) return;
  Solution finished = rounds_.solve(input, input.detections, best.pose.pose, &previous, Rounds::kFinishing);
  if (finished.pose.status == SolveStatus::kOk) best = std::move(finished);
}

// A network that insists on the other legs may be right: silhouette and matches hold a leg where the other should be.
// Or legs cross under a skirt and it needs longer: where there is a picture, that decides. So it does where two poses
// on end are not believable: legs seen from the side may have been taken for each other, and hold themselves there; one
// may be the network's mistake. E_temporal and what holds hidden arms are the old pose's alone.
void PoseStage::try_anew(const PoseStageInput& input, const Pose& previous, Solution& best) {
  exchanged_frames_ = 0;
  Solution anew = solve_anew(input, {});
  if (anew.pose.status != SolveStatus::kOk) return;
  double old_alone = best.pose.energy.temporal;
  if (input.detected) old_alone += held_energy(actor_, input.detections, previous, options_.pose, best.pose.pose);
  const bool keeps =
      rounds_.matches(input) && best.pose.status == SolveStatus::kOk && best.cost - old_alone <= anew.cost;
  if (!keeps) best = std::move(anew);
}

void PoseStage::try_exchanged_legs(const PoseStageInput& input, const Pose& predicted, const Pose& previous,
                                   const std::vector<KeypointDetections>& alternatives, Solution& best) {
  for (const KeypointDetections& keypoints : alternatives) {
    Detections detections;
    detections.person = true;
    detections.keypoints = keypoints;
    Solution other = rounds_.solve(input, detections, predicted, &previous, Rounds::kAll);
    other.exchanged = true;
    if (other.pose.status != SolveStatus::kOk) continue;
    if (best.pose.status != SolveStatus::kOk || covers_more(input, other, best)) best = std::move(other);
  }
}

// A body one stripe further round fits its matches, but nothing else as well.
void PoseStage::try_turned(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!rounds_.matches(input) || best.pose.status != SolveStatus::kOk) return;
  const std::optional<Pose> turned =
      turned_trunk(actor_, best.pose.pose, input.detections, options_.pose, options_.starts.least_turn_rad);
  if (turned) try_from(input, *turned, previous, best);
}

// A skirt whose pattern was matched one stripe further round took the pelvis along.
void PoseStage::try_untwisted(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!rounds_.matches(input) || best.pose.status != SolveStatus::kOk) return;
  const std::optional<Pose> untwisted = untwisted_pelvis(actor_, best.pose.pose, options_.starts.least_twist_rad);
  if (!untwisted)
    twisted_frames_ = 0;
  else if (twisted_frames_++ % options_.starts.twisted_frames == 0)
    try_from(input, *untwisted, previous, best);
}

// From where the leg is held the true one is another minimum, which E_temporal keeps it from.
void PoseStage::try_other_legs(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!rounds_.matches(input) || best.pose.status != SolveStatus::kOk) return;
  const bool on_edge = stands_on_edge(actor_, best.pose.pose, previous, floor_.up(), options_.starts.on_edge_rad);
  on_edge_frames_ = on_edge ? on_edge_frames_ + 1 : 0;
  if (!on_edge || on_edge_frames_ < options_.starts.on_edge_frames) return;
  on_edge_frames_ = 0;
  for (const Pose& start : with_other_legs(actor_.skeleton, best.pose.pose)) try_from(input, start, previous, best);
}

void PoseStage::try_detected_legs(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!rounds_.matches(input) || best.pose.status != SolveStatus::kOk) return;
  const double least_px = options_.starts.strayed_share * keypoints_height_px(input.detections);
  if (!(least_px > 0)) return;
  struct Start {
    Detections detections;
    std::optional<Pose> bent;
  };
  const auto start_from = [&](const KeypointDetections& keypoints) {
    Start start;
    start.detections.person = true;
    start.detections.keypoints = keypoints;
    start.bent = with_detected_legs(actor_, camera_, best.pose.pose, start.detections, options_.pose, least_px);
    return start;
  };
  std::vector<Start> starts = {start_from(input.detections.keypoints)};
  if (!starts[0].bent) return;
  const Start others[] = {start_from(with_legs_exchanged(input.detections.keypoints, true)),
                          start_from(with_legs_exchanged(input.detections.keypoints, false))};
  const bool fits_none = input.detected && others[0].bent && others[1].bent;
  const bool exchanged = fits_none && best.exchanged;  // by the names that it goes by
  if (exchanged) starts.assign(std::begin(others), std::end(others));
  make_comparable(input, previous, best);
  for (const Start& start : starts) {
    Solution other = rounds_.solve(input, start.detections, *start.bent, &previous, Rounds::kAll);
    other.exchanged = exchanged;
    if (other.pose.status != SolveStatus::kOk) continue;
    if (fits_none ? covers_more(input, other, best) : other.cost < best.cost) best = std::move(other);
  }
}

// The network's elbows are bent too far, so that what an arm costs where the detections have it says little of which
// arm is right. But one that a turn hid and that is held inside the trunk since leaves a part of the picture uncovered.
void PoseStage::try_detected_arms(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!input.detected || !rounds_.matches(input) || best.pose.status != SolveStatus::kOk || best.exchanged) return;
  const double least_px = options_.starts.strayed_arm_share * keypoints_height_px(input.detections);
  if (!(least_px > 0)) return;
  const auto better_of = [&](const Pose& bent) {
    make_comparable(input, previous, best);
    Solution other = rounds_.solve(input, input.detections, bent, &previous, Rounds::kAll);
    if (other.pose.status == SolveStatus::kOk && covers_more(input, other, best)) best = std::move(other);
    return best.pose.pose;
  };
  with_detected_arms(actor_, camera_, best.pose.pose, input.detections, options_.pose,
                     {least_px, options_.starts.strayed_arm_depth_mm}, better_of);
}

// A leg that crossed the other one may be left on its shoe. What the picture shows of it then is covered by nothing,
// which costs nothing, and to leave costs E_temporal. And legs solved by the wrong names may end up crossed, at hardly
// another cost.
bool PoseStage::covers_more(const PoseStageInput& input, const Solution& other, const Solution& best) {
  if (input.silhouette.empty()) return other.cost < best.cost;
  const auto iou = [&](const Solution& solution) {
    rounds_.render(solution.pose.pose);
    return rasterizer_.intersection_over_union(input.frame.mask);
  };
  const double gained = iou(other) - iou(best);
  const auto cost = [](const Solution& solution) { return solution.pose.energy.with_doubt(solution.cost); };
  return cost(other) < cost(best) * (1 + options_.starts.cost_of_covering * gained);
}

void PoseStage::try_mirrored_forearms(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!rounds_.shading(input) || best.pose.status != SolveStatus::kOk || best.exchanged) return;
  for (Keypoint elbow : {kLeftElbow, kRightElbow}) {
    const auto other = mirrored_forearm(actor_, best.pose.pose, elbow, options_.starts.least_mirrored_rad);
    if (!other) continue;
    const auto misfit = [&](const Eigen::Matrix3d& turn) {
      return rounds_.skin_shading().misfit(best.skin, other->bone, turn, options_.pose.shading_huber);
    };
    if (misfit(other->turn) < options_.starts.mirrored_misfit * misfit(Eigen::Matrix3d::Identity()))
      try_refined(input, with_mirrored_forearm(actor_, best.pose.pose, *other), previous, best);
  }
}

// From the last rounds on: the rest of the body stays, so that the costs tell the arms apart. Unlike other starts
// without what was not matched: here that is chance.
void PoseStage::try_refined(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best) {
  make_comparable(input, previous, best);
  Solution solved = rounds_.solve(input, input.detections, initial, &previous, Rounds::kRefining);
  const auto doubted = [](const PoseEnergies& energy) { return energy.with_doubt(energy.total()); };
  if (solved.pose.status == SolveStatus::kOk && doubted(solved.pose.energy) < doubted(best.pose.energy))
    best = std::move(solved);
}

void PoseStage::try_from(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best) {
  make_comparable(input, previous, best);
  keep_better(rounds_.solve(input, input.detections, initial, &previous, Rounds::kAll), best);
}

void PoseStage::keep_better(Solution other, Solution& best) {
  if (other.pose.status != SolveStatus::kOk) return;
  if (best.pose.status == SolveStatus::kOk && other.cost >= best.cost) return;
  best = std::move(other);
}

}  // namespace livecap
