#include "capture/pose_stage.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "base/log.h"
#include "cloth/hanging_cloth.h"
#include "pose/mirrored_forearm.h"
#include "pose/other_starts.h"
#include "pose/person_height.h"

namespace livecap {
namespace {

std::vector<float> matched_share(const Actor& actor, const TrackerOptions& options) {
  const std::vector<float> legs = leg_weights(actor);
  std::vector<float> share(actor.n_vertices());
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const bool follows =
        actor.rigidity[i] >= options.shares.min_matched_rigidity || legs[i] < options.shares.max_matched_leg_weight;
    share[i] = follows ? 1.0f : 0.0f;
  }
  return share;
}

// In the last rounds.
std::vector<float> refined_share(const Actor& actor, const TrackerOptions& options) {
  std::vector<float> share = matched_share(actor, options);
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i)) share[i] *= options.shares.refined_hanging_share;
  return share;
}

// And where no starts compete.
std::vector<float> on_feet_share(const Actor& actor, const TrackerOptions& options) {
  std::vector<float> share = refined_share(actor, options);
  const int left_foot = actor.skeleton.bone_index("left_ankle"), right_foot = actor.skeleton.bone_index("right_ankle");
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const int strongest = actor.skin.bones[4 * i];
    if (strongest == left_foot || strongest == right_foot) share[i] *= options.shares.foot_share;
  }
  return share;
}

// Of the vertices, so few are wrong labels.
constexpr double kFewHanging = 0.02;

bool wears_hanging_cloth(const Actor& actor) {
  int n = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) n += hangs(actor, i);
  return n > kFewHanging * actor.n_vertices();
}

TrackerOptions options_for(const Actor& actor, TrackerOptions options) {
  if (!actor.guessed_weights) return options;
  options.pose.weights.keypoint_2d *= options.guessed.keypoint_2d;
  if (wears_hanging_cloth(actor)) return options;
  options.pose.weights.silhouette *= options.guessed.silhouette;
  options.pose.weights.shading *= options.guessed.shading;
  return options;
}

std::vector<uint8_t> is_matched(const Actor& actor, const TrackerOptions& options) {
  const std::vector<float> share = matched_share(actor, options);
  return {share.begin(), share.end()};
}

}  // namespace

PoseStage::PoseStage(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                     const TrackerOptions& options, DepthRasterizer& rasterizer, SurfaceVisibility& visibility)
    : device_(device),
      actor_(actor),
      camera_(camera),
      options_(options_for(actor, (options.validate(), options))),
      skin_(hanging_weights(actor, options.hanging)),
      skinner_(device, actor, skin_, actor.skeleton.n_bones()),
      rasterizer_(rasterizer),
      visibility_(visibility),
      matcher_(device, actor, camera, options.match),
      shading_(device, actor, camera, options.shading),
      sight_(device, camera, skinner_, rasterizer, visibility, matcher_, shading_),
      floor_(actor, options.floor, measured_floor(camera)),
      leg_bias_(options.leg_bias),
      solver_(device, actor, skin_, camera, options_.pose),
      zero_(device, size_t(3) * actor.n_vertices()),
      skinned_(device, size_t(3) * actor.n_vertices()),
      normals_(device, size_t(3) * actor.n_vertices()),
      matched_share_(device, matched_share(actor, options)),
      refined_share_(device, refined_share(actor, options)),
      on_feet_share_(device, on_feet_share(actor, options)),
      refining_candidates_(visibility.contour_candidates(is_matched(actor, options))) {
  for (ocl::Buffer<float>* buffer : {&zero_, &skinned_, &normals_}) buffer->fill(0);
}

bool PoseStage::matches(const PoseStageInput& input) const {
  return matcher_.usable() && options_.pose.weights.match > 0 && !options_.rounds.match_levels.empty() &&
         !input.silhouette.empty();
}

bool PoseStage::counts_feet(const PoseStageInput& input) const {
  return matches(input) && options_.shares.foot_share > 1;
}

bool PoseStage::shading(const PoseStageInput& input) const {
  return shading_.usable() && options_.pose.weights.shading > 0 && !input.silhouette.empty();
}

void PoseStage::set_picture(const PoseStageInput& input) {
  if (!matches(input)) return;
  picture_due_ = true;
  if (looks_ahead(input)) {
    matcher_.set_box(input.frame, input.silhouette.box);
  } else {
    find_picture(input);
  }
}

void PoseStage::find_picture(const PoseStageInput& input) {
  if (picture_due_) matcher_.set_picture(input.frame, input.silhouette.box);
  picture_due_ = false;
}

// Whether all rounds are launched before the first is over.
bool PoseStage::looks_ahead(const PoseStageInput& input) const {
  return sight_.usable() && solver_.chooses() && matches(input) &&
         options_.rounds.match_levels.size() <= LC_POSE_MOST_ROUNDS;
}

void PoseStage::reset() {
  lose_person();
  last_skin_.clear();
  shading_.forget();
  floor_.forget();
  leg_bias_.forget();
}

void PoseStage::learn(const Pose* previous, const Pose& pose, const Detections& detections) {
  shading_.learn(last_skin_);
  leg_bias_.learn(actor_, detections.keypoints, pose);
  if (!previous || floor_.is_contradicted()) return;
  floor_.learn(*previous, pose, detections);
  if (floor_.is_contradicted())
    log_warning("feet do not rest on the floor of camera.json; was the camera moved since it was measured?");
}

void PoseStage::render(const Pose& pose) {
  skinner_.set_pose(bone_dual_quats(forward_kinematics(actor_.skeleton, pose)));
  skinner_.skin(zero_, skinned_);
  rasterizer_.render(skinned_, camera_);
}

// The contour vertices of stage I: of the skinned template alone. The paper also adds the carried displacement. That
// ties the pose to what the surface made of an earlier pose; without it the pose was as good or better on every
// sequence with ground truth.
void PoseStage::find_contour(const PoseStageInput& input, const Pose& pose) {
  if (input.silhouette.empty()) return;
  render(pose);
  visibility_.find_contour(rasterizer_);
}

// Blocking.
std::vector<int32_t> PoseStage::read_contour(const PoseStageInput& input) {
  return input.silhouette.empty() ? std::vector<int32_t>{} : visibility_.read_contour();
}

// And which vertices the camera sees; there is a silhouette.
void PoseStage::find_contour_and_visible(const Pose& pose, bool refining) {
  render(pose);
  skinner_.normals(skinned_, normals_);
  if (refining) {
    visibility_.find_visible_and_contour(skinned_, normals_, rasterizer_, refining_candidates_);
  } else {
    visibility_.find_visible_and_contour(skinned_, normals_, rasterizer_);
  }
}

void PoseStage::find_matches(const PoseStageInput& input, int level, const ocl::Buffer<float>& share) {
  find_picture(input);
  matcher_.match(rasterizer_, skinned_, normals_, visibility_.visible(), share, level);
}

const ocl::Buffer<float>& PoseStage::share_in(Rounds rounds, bool refining) const {
  return !refining ? matched_share_ : counts_feet(rounds) ? on_feet_share_ : refined_share_;
}

int PoseStage::first_of(Rounds rounds, const PoseStageInput& input) const {
  const int n_levels = matches(input) ? int(options_.rounds.match_levels.size()) : 0;
  const int n_last = rounds == Rounds::kRefining    ? options_.rounds.refining_rounds
                     : rounds == Rounds::kFinishing ? 1
                                                    : n_levels;
  return std::max(0, n_levels - n_last);
}

// Once per level of match_levels, less where the last round at the same level was settled; or once when there is
// nothing to match.
PoseStage::Solution PoseStage::solve_in_rounds(const PoseStageInput& input, const Detections& detections,
                                               const Pose& initial, const Pose* previous, Rounds rounds) {
  if (looks_ahead(input)) {
    std::optional<Solution> ahead = solve_ahead(input, detections, initial, previous, rounds);
    if (ahead) return std::move(*ahead);
    picture_due_ = true;  // it may have been in vain
  }
  const int n_levels = matches(input) ? int(options_.rounds.match_levels.size()) : 0,
            first_round = first_of(rounds, input);
  Solution solution;
  solution.pose.pose = initial;
  bool was_refining = false;
  for (int round = first_round; round < std::max(1, n_levels) && solution.pose.status == SolveStatus::kOk; ++round) {
    const int level = round < n_levels ? options_.rounds.match_levels[round] : 0;
    const bool refining = n_levels > 0 && round >= n_levels - options_.rounds.refining_rounds;
    const bool again =
        round > first_round && level == options_.rounds.match_levels[round - 1] && refining == was_refining;
    was_refining = refining;
    if (again && solution.pose.moved_px < options_.rounds.settled_round_px * (1 << level)) continue;
    const Pose from = solution.pose.pose;
    const bool shades = level == 0 && shading(input);
    if (n_levels > 0 || shades) {
      find_contour_and_visible(from, refining);
    } else {
      find_contour(input, from);
    }
    if (n_levels > 0) find_matches(input, level, share_in(rounds, refining));
    if (shades) shading_.measure(input.frame, rasterizer_, skinned_, normals_, visibility_.visible());
    PoseInput solve = round_input(input, detections, from, previous, level, rounds, refining);
    solution.pose = solver_.chooses() ? solve_seen(solve, n_levels > 0, shades, solution.skin)
                                      : solve_read(solve, n_levels > 0, shades, solution.skin);
    solution.cost = cost_of(solution.pose);
  }
  return solution;
}

PoseInput PoseStage::round_input(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                                 const Pose* previous, int level, Rounds rounds, bool refining) const {
  return {.detections = detections,
          .initial = initial,
          .previous = previous,
          .frame = input.silhouette.empty() ? nullptr : &input.frame,
          .floor = floor_.floor(),
          .share_3d = matches(input) ? options_.rounds.matched_3d : 1,
          .arms_3d = refining ? options_.rounds.refined_arms_3d : 1,
          .legs_3d = refining && counts_feet(rounds) ? options_.rounds.on_feet_legs_3d : 1,
          .doubt_3d_mm = refining ? options_.rounds.refined_doubt_3d_mm : 0,
          .n_steps = previous ? options_.pose.steps : options_.pose.first_steps,
          .settled_px = level == 0 ? options_.rounds.settled_last_step_px : options_.rounds.settled_step_px};
}

// The same rounds on a GPU that decides between them by itself; the host waits once. Nothing where that did not work.
std::optional<PoseStage::Solution> PoseStage::solve_ahead(const PoseStageInput& input, const Detections& detections,
                                                          const Pose& initial, const Pose* previous, Rounds which) {
  const std::vector<int>& levels = options_.rounds.match_levels;
  const int first_round = first_of(which, input), n_rounds = int(levels.size()) - first_round;
  const bool has_skin = shading(input);
  SeenVertices known;
  known.match_area_px = matcher_.weight_area_px();
  if (has_skin) known.skin = shading_.seen();
  const auto refines = [&](int round) { return round >= int(levels.size()) - options_.rounds.refining_rounds; };
  std::vector<PoseInput> inputs;
  std::vector<PoseSolver::Round> rounds;
  inputs.reserve(n_rounds);
  for (int round = first_round; round < int(levels.size()); ++round) {
    const int level = levels[round];
    const bool again = round > first_round && level == levels[round - 1] && refines(round) == refines(round - 1);
    inputs.push_back(round_input(input, detections, initial, previous, level, which, refines(round)));
    rounds.push_back({&inputs.back(), again ? options_.rounds.settled_round_px * (1 << level) : 0});
  }
  if (rounds.empty()) return std::nullopt;
  const PoseSystem& system = solver_.system();
  solver_.start_rounds(initial);
  bool shades = false;
  for (int k = 0; k < n_rounds; ++k) {
    const int level = levels[first_round + k];
    const bool refining = refines(first_round + k), shades_now = has_skin && level == 0;
    shades = shades || shades_now;
    sight_.look({.level = level,
                 .new_picture = std::exchange(picture_due_, false),
                 .shades = shades_now,
                 .frame = input.frame,
                 .motions = system.motions(),
                 .displacement = zero_,
                 .share = share_in(which, refining),
                 .candidates = refining ? &refining_candidates_ : nullptr,
                 .skinned = skinned_,
                 .normals = normals_,
                 .moved = system.moved(),
                 .least_moved_px = k > 0 ? float(rounds[k].least_moved_px) : -INFINITY,
                 .state = system.look_state()});
    if (k == 0 && !solver_.begin_rounds(rounds, known)) return std::nullopt;  // while the device looks
    SeenVertices seen = known;
    seen.contour = &visibility_.contour();
    seen.matches = &matcher_.matches();
    if (!shades_now) seen.skin.samples = nullptr;
    solver_.launch_round(k, seen);
  }
  if (shades) shading_.read_later();
  std::optional<PoseResult> result = solver_.finish_rounds();
  if (!result || result->status != SolveStatus::kOk) return std::nullopt;
  Solution solution;
  solution.pose = std::move(*result);
  solution.cost = cost_of(solution.pose);
  if (shades) solution.skin = shading_.samples();
  return solution;
}

// With E_temporal as doubted_cost() has it (pose/targets.h).
double PoseStage::cost_with_doubt(const Solution& solution) {
  const PoseEnergies& energy = solution.pose.energy;
  return solution.cost - energy.temporal + energy.doubted_temporal;
}

double PoseStage::cost_of(const PoseResult& pose) const {
  return pose.energy.total() +
         options_.pose.weights.match * pose.missed_weight * options_.rounds.missed_px * options_.rounds.missed_px;
}

// With the vertices that the device chooses of what it has found. skin: what was seen of it.
PoseResult PoseStage::solve_seen(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin) {
  SeenVertices seen;
  if (solve.frame) seen.contour = &visibility_.contour();
  if (matches) seen.matches = &matcher_.matches();
  seen.match_area_px = matcher_.weight_area_px();
  if (shades) seen.skin = shading_.seen();
  if (shades) shading_.read_later();
  solve.seen = &seen;
  const PoseResult result = solver_.solve(solve);
  if (shades) skin = shading_.samples();
  return result;
}

// The same with vertices that are read.
PoseResult PoseStage::solve_read(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin) {
  if (matches) matcher_.read_later();
  if (shades) shading_.read_later();
  if (solve.frame) visibility_.read_contour_later();
  const PoseSolver::Prepared prepared = solver_.prepare(solve);  // a GPU is still at work on the rest
  if (solve.frame) device_.finish();
  const std::vector<int32_t> contour = solve.frame ? visibility_.contour_found() : std::vector<int32_t>{};
  const Matches found = matches ? matcher_.found() : Matches{};
  if (shades) skin = shading_.samples();
  const std::vector<ShadedVertex> shaded = shades ? shading_.shaded(skin) : std::vector<ShadedVertex>{};
  solve.contour_vertices = contour;
  solve.matches = found.found;
  solve.shaded = shaded;
  PoseResult result = solver_.solve(solve, prepared);
  result.missed_weight = found.missed_weight;
  return result;
}

// The contour found on a rough pose is only a start: once more from where that solve ends.
PoseStage::Solution PoseStage::solve_anew(const PoseStageInput& input) {
  const std::optional<Pose> initial = initialize_pose(actor_, camera_, input.detections, options_.pose);
  Solution anew;
  anew.pose.status = SolveStatus::kNoObservations;
  if (!initial) return anew;
  find_contour(input, *initial);
  const std::vector<int32_t> contour = read_contour(input);
  anew.pose = solver_.solve(PoseInput{.detections = input.detections,
                                      .initial = *initial,
                                      .frame = input.silhouette.empty() ? nullptr : &input.frame,
                                      .contour_vertices = contour,
                                      .floor = floor_.floor(),
                                      .n_steps = options_.pose.first_steps});
  if (anew.pose.status != SolveStatus::kOk) return anew;
  return solve_in_rounds(input, input.detections, anew.pose.pose, nullptr);
}

PoseResult PoseStage::find(const PoseStageInput& input) {
  Solution found = solve_anew(input);
  if (found.pose.status == SolveStatus::kOk) last_skin_ = std::move(found.skin);
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
  const bool on_feet = alternatives.empty() && counts_feet(input);
  Solution best =
      solve_in_rounds(input, input.detections, predicted, &previous, on_feet ? Rounds::kOnFeet : Rounds::kAll);
  best.is_comparable = !on_feet;
  try_exchanged_legs(input, predicted, previous, alternatives, best);
  try_turned(input, previous, best);
  try_detected_legs(input, previous, best);
  try_mirrored_forearms(input, previous, best);
  const bool insists = best.exchanged && exchanged_frames_ >= options_.starts.max_exchanged_frames;
  if (insists) try_anew(input, best);
  const bool doubted = input.detected && !believable(best.pose, input.detections);
  if (std::exchange(doubted_, doubted) && doubted && !insists && matches(input)) {
    make_comparable(input, previous, best);
    try_anew(input, best);
  }
  if (best.exchanged) ++exchanged_frames_;
  finish(input, previous, best);
  last_skin_ = std::move(best.skin);
  return best.pose;
}

// Starts are compared where feet count as all else does: legs that are exchanged hold on to the wrong shoes.
void PoseStage::make_comparable(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (std::exchange(best.is_comparable, true)) return;
  Solution other = solve_in_rounds(input, input.detections, best.pose.pose, &previous, Rounds::kRefining);
  if (other.pose.status != SolveStatus::kOk) return;
  best = std::move(other);
}

void PoseStage::finish(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!best.is_comparable || !counts_feet(input) || best.exchanged) return;
  if (best.pose.status != SolveStatus::kOk) return;
  Solution finished = solve_in_rounds(input, input.detections, best.pose.pose, &previous, Rounds::kFinishing);
  if (finished.pose.status == SolveStatus::kOk) best = std::move(finished);
}

// A network that insists on the other legs may be right: silhouette and matches hold a leg where the other should be.
// Or legs cross under a skirt and it needs longer: where there is a picture, that decides. So it does where two poses
// on end are not believable: legs seen from the side may have been taken for each other, and hold themselves there; one
// may be the network's mistake. E_temporal is the old pose's alone.
void PoseStage::try_anew(const PoseStageInput& input, Solution& best) {
  exchanged_frames_ = 0;
  Solution anew = solve_anew(input);
  if (anew.pose.status != SolveStatus::kOk) return;
  const bool keeps =
      matches(input) && best.pose.status == SolveStatus::kOk && best.cost - best.pose.energy.temporal <= anew.cost;
  if (!keeps) best = std::move(anew);
}

void PoseStage::try_exchanged_legs(const PoseStageInput& input, const Pose& predicted, const Pose& previous,
                                   const std::vector<KeypointDetections>& alternatives, Solution& best) {
  for (const KeypointDetections& keypoints : alternatives) {
    Detections detections;
    detections.person = true;
    detections.keypoints = keypoints;
    Solution other = solve_in_rounds(input, detections, predicted, &previous);
    other.exchanged = true;
    keep_better(std::move(other), best);
  }
}

// A body one stripe further round fits its matches, but nothing else as well.
void PoseStage::try_turned(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!matches(input) || best.pose.status != SolveStatus::kOk) return;
  const std::optional<Pose> turned =
      turned_trunk(actor_, best.pose.pose, input.detections, options_.pose, options_.starts.least_turn_rad);
  if (turned) try_from(input, *turned, previous, best);
}

void PoseStage::try_detected_legs(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!matches(input) || best.pose.status != SolveStatus::kOk) return;
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
    Solution other = solve_in_rounds(input, start.detections, *start.bent, &previous);
    other.exchanged = exchanged;
    if (other.pose.status != SolveStatus::kOk) continue;
    if (fits_none ? covers_more(input, other, best) : other.cost < best.cost) best = std::move(other);
  }
}

// A leg that crossed the other one may be left on its shoe. What the picture shows of it then is covered by nothing,
// which costs nothing, and to leave costs E_temporal.
bool PoseStage::covers_more(const PoseStageInput& input, const Solution& other, const Solution& best) {
  const auto iou = [&](const Solution& solution) {
    render(solution.pose.pose);
    return rasterizer_.intersection_over_union(input.frame.mask);
  };
  const double gained = iou(other) - iou(best);
  return cost_with_doubt(other) < cost_with_doubt(best) * (1 + options_.starts.cost_of_covering * gained);
}

void PoseStage::try_mirrored_forearms(const PoseStageInput& input, const Pose& previous, Solution& best) {
  if (!shading(input) || best.pose.status != SolveStatus::kOk || best.exchanged) return;
  for (Keypoint elbow : {kLeftElbow, kRightElbow}) {
    const auto other = mirrored_forearm(actor_, best.pose.pose, elbow, options_.starts.least_mirrored_rad);
    if (!other) continue;
    const auto misfit = [&](const Eigen::Matrix3d& turn) {
      return shading_.misfit(best.skin, other->bone, turn, options_.pose.shading_huber);
    };
    if (misfit(other->turn) < options_.starts.mirrored_misfit * misfit(Eigen::Matrix3d::Identity()))
      try_refined(input, with_mirrored_forearm(actor_, best.pose.pose, *other), previous, best);
  }
}

// From the last rounds on: the rest of the body stays, so that the costs tell the arms apart. Unlike other starts
// without what was not matched: here that is chance.
void PoseStage::try_refined(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best) {
  make_comparable(input, previous, best);
  Solution solved = solve_in_rounds(input, input.detections, initial, &previous, Rounds::kRefining);
  const auto doubted = [](const PoseEnergies& e) { return e.total() - e.temporal + e.doubted_temporal; };
  if (solved.pose.status == SolveStatus::kOk && doubted(solved.pose.energy) < doubted(best.pose.energy))
    best = std::move(solved);
}

void PoseStage::try_from(const PoseStageInput& input, const Pose& initial, const Pose& previous, Solution& best) {
  make_comparable(input, previous, best);
  keep_better(solve_in_rounds(input, input.detections, initial, &previous), best);
}

void PoseStage::keep_better(Solution other, Solution& best) {
  if (other.pose.status != SolveStatus::kOk) return;
  if (best.pose.status == SolveStatus::kOk && other.cost >= best.cost) return;
  best = std::move(other);
}

}  // namespace livecap
