#include "capture/pose_rounds.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "capture/pose_shares.h"
#include "cloth/hanging_cloth.h"

namespace livecap {

PoseRounds::PoseRounds(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                       const TrackerOptions& options, const FloorFinder& floor, DepthRasterizer& rasterizer,
                       SurfaceVisibility& visibility)
    : device_(device),
      actor_(actor),
      camera_(camera),
      options_(options),
      floor_(floor),
      skin_(hanging_weights(actor, options.hanging)),
      skinner_(device, actor, skin_, actor.skeleton.n_bones()),
      rasterizer_(rasterizer),
      visibility_(visibility),
      matcher_(device, actor, camera, options.match),
      shading_(device, actor, camera, options.shading),
      actor_light_(options.actor_light),
      sight_(device, camera, skinner_, rasterizer, visibility, matcher_, shading_),
      solver_(device, actor, skin_, camera, options.pose),
      zero_(device, size_t(3) * actor.n_vertices()),
      skinned_(device, size_t(3) * actor.n_vertices()),
      normals_(device, size_t(3) * actor.n_vertices()),
      matched_share_(device, matched_share(actor, options.shares, options.hanging)),
      refined_share_(device, refined_share(actor, options.shares, options.hanging)),
      on_feet_share_(device, on_feet_share(actor, options.shares, options.hanging)),
      refining_candidates_(visibility.contour_candidates(is_matched(actor, options.shares, options.hanging))) {
  for (ocl::Buffer<float>* buffer : {&zero_, &skinned_, &normals_}) buffer->fill(0);
}

bool PoseRounds::matches(const PoseStageInput& input) const {
  return matcher_.usable() && options_.pose.weights.match > 0 && !options_.rounds.match_levels.empty() &&
         !input.silhouette.empty();
}

bool PoseRounds::counts_feet(const PoseStageInput& input) const {
  return matches(input) && options_.shares.foot_share > 1;
}

bool PoseRounds::shading(const PoseStageInput& input) const {
  return shading_.usable() && options_.pose.weights.shading > 0 && !input.silhouette.empty();
}

bool PoseRounds::looks_ahead(const PoseStageInput& input) const {
  return sight_.usable() && solver_.chooses() && matches(input) &&
         options_.rounds.match_levels.size() <= LC_POSE_MOST_ROUNDS;
}

void PoseRounds::set_picture(const PoseStageInput& input) {
  if (!matches(input)) return;
  first_seen_weight_ = 0;
  picture_due_ = true;
  if (looks_ahead(input)) {
    matcher_.set_box(input.frame, input.silhouette.box);
  } else {
    find_picture(input);
  }
}

void PoseRounds::find_picture(const PoseStageInput& input) {
  if (picture_due_) matcher_.set_picture(input.frame, input.silhouette.box);
  picture_due_ = false;
}

void PoseRounds::learn_light(const PoseStageInput& input, int drawn) {
  if (!matches(input) || drawn != n_drawn_) return;
  actor_light_.learn(matcher_.sample_light(input.frame, rasterizer_, skinned_, normals_, visibility_.visible()));
  if (!actor_light_.known()) return;
  Light light;
  for (size_t k = 0; k < light.size(); ++k) light[k] = float(actor_light_.light()[k]);
  matcher_.set_light(light);
}

void PoseRounds::forget_light() {
  actor_light_ = HarmonicLight(options_.actor_light);
  matcher_.set_light({1});
}

void PoseRounds::render(const Pose& pose) {
  ++n_drawn_;
  skinner_.set_pose(bone_dual_quats(forward_kinematics(actor_.skeleton, pose)));
  skinner_.skin(zero_, skinned_);
  rasterizer_.render(skinned_, camera_);
}

// The contour vertices of stage I: of the skinned template alone. The paper also adds the carried displacement. That
// ties the pose to what the surface made of an earlier pose; without it the pose was as good or better on every
// sequence with ground truth.
void PoseRounds::find_contour(const PoseStageInput& input, const Pose& pose) {
  if (input.silhouette.empty()) return;
  render(pose);
  visibility_.find_contour(rasterizer_);
}

// And which vertices the camera sees; there is a silhouette.
void PoseRounds::find_contour_and_visible(const Pose& pose, bool refining) {
  render(pose);
  skinner_.normals(skinned_, normals_);
  if (refining) {
    visibility_.find_visible_and_contour(skinned_, normals_, rasterizer_, refining_candidates_);
  } else {
    visibility_.find_visible_and_contour(skinned_, normals_, rasterizer_);
  }
}

void PoseRounds::find_matches(const PoseStageInput& input, const Round& round) {
  find_picture(input);
  matcher_.match(rasterizer_, skinned_, normals_, visibility_.visible(), share_in(round), round.level);
}

const ocl::Buffer<float>& PoseRounds::share_in(const Round& round) const {
  return !round.refining ? matched_share_ : round.on_feet ? on_feet_share_ : refined_share_;
}

// One per level of match_levels; or one when there is nothing to match.
std::vector<PoseRounds::Round> PoseRounds::plan_rounds(const PoseStageInput& input, Rounds rounds) const {
  const bool has_skin = shading(input);
  if (!matches(input)) return {Round{.shades = has_skin}};
  const std::vector<int>& levels = options_.rounds.match_levels;
  const int n_levels = int(levels.size());
  const bool refines = rounds == Rounds::kRefining || rounds == Rounds::kFreeLegs;
  const int n_last = refines                        ? std::max(1, options_.rounds.refining_rounds)
                     : rounds == Rounds::kFinishing ? 1
                                                    : n_levels;
  std::vector<Round> plan;
  for (int k = std::max(0, n_levels - n_last); k < n_levels; ++k) {
    Round round;
    round.level = levels[k];
    round.refining = k >= n_levels - options_.rounds.refining_rounds;
    round.on_feet = round.refining && rounds != Rounds::kAll && rounds != Rounds::kRefining;
    round.free_legs = rounds == Rounds::kFreeLegs;
    round.shades = has_skin && round.level == 0;
    const bool again = !plan.empty() && round.level == plan.back().level && round.refining == plan.back().refining;
    if (again) round.least_moved_px = options_.rounds.settled_round_px * (1 << round.level);
    plan.push_back(round);
  }
  return plan;
}

PoseRounds::Solution PoseRounds::solve(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                                       const Pose* previous, Rounds rounds) {
  const std::vector<Round> plan = plan_rounds(input, rounds);
  if (looks_ahead(input)) {
    std::optional<Solution> ahead = solve_ahead(input, detections, initial, previous, plan);
    if (ahead) {
      ahead->drawn = ++n_drawn_;
      return std::move(*ahead);
    }
    picture_due_ = true;  // it may have been in vain
  }
  const bool has_matches = matches(input);
  Solution solution;
  solution.pose.pose = initial;
  for (const Round& round : plan) {
    if (solution.pose.moved_px < round.least_moved_px) continue;
    const Pose from = solution.pose.pose;
    if (has_matches || round.shades) {
      find_contour_and_visible(from, round.refining);
    } else {
      find_contour(input, from);
    }
    if (has_matches) find_matches(input, round);
    if (round.shades) shading_.measure(input.frame, rasterizer_, skinned_, normals_, visibility_.visible());
    PoseInput solve = round_input(input, detections, from, previous, round);
    solution.pose = solver_.chooses() ? solve_seen(solve, has_matches, round.shades, solution.skin)
                                      : solve_read(solve, has_matches, round.shades, solution.skin);
    solution.cost = cost_of(solution.pose);
    if (solution.pose.status != SolveStatus::kOk) break;
  }
  solution.drawn = ++n_drawn_;
  return solution;
}

PoseInput PoseRounds::round_input(const PoseStageInput& input, const Detections& detections, const Pose& initial,
                                  const Pose* previous, const Round& round) const {
  const PoseRoundsOptions& options = options_.rounds;
  const double legs_3d = round.free_legs ? options.free_legs_3d : round.on_feet ? options.on_feet_legs_3d : 1;
  return {.detections = detections,
          .initial = initial,
          .previous = round.free_legs ? nullptr : previous,
          .holds_arms = input.detected,
          .frame = input.silhouette.empty() ? nullptr : &input.frame,
          .match_px = previous ? 1 : double(1 << round.level),  // who is seen first may be far from where matches are
          .floor = round.free_legs ? nullptr : floor_.floor(),
          .share_3d = matches(input) ? options.matched_3d : 1,
          .arms_3d = round.refining ? options.refined_arms_3d : 1,
          .legs_3d = legs_3d,
          .doubt_3d_mm = round.refining ? options.refined_doubt_3d_mm : 0,
          .n_steps = previous ? options_.pose.steps : options_.pose.first_steps,
          .settled_px = round.level == 0 ? options.settled_last_step_px : options.settled_step_px};
}

// The same rounds on a GPU that decides between them by itself; the host waits once. Nothing where that did not work.
std::optional<PoseRounds::Solution> PoseRounds::solve_ahead(const PoseStageInput& input, const Detections& detections,
                                                            const Pose& initial, const Pose* previous,
                                                            const std::vector<Round>& plan) {
  if (plan.empty()) return std::nullopt;
  SeenVertices known;
  known.match_area_px = matcher_.weight_area_px();
  if (shading(input)) known.skin = shading_.seen();
  std::vector<PoseInput> inputs;
  std::vector<PoseSolver::Round> rounds;
  inputs.reserve(plan.size());
  for (const Round& round : plan) {
    inputs.push_back(round_input(input, detections, initial, previous, round));
    rounds.push_back({&inputs.back(), round.least_moved_px});
  }
  const PoseSystem& system = solver_.system();
  solver_.start_rounds(initial);
  bool shades = false;
  for (int k = 0; k < int(plan.size()); ++k) {
    const Round& round = plan[k];
    shades = shades || round.shades;
    sight_.look({.level = round.level,
                 .new_picture = std::exchange(picture_due_, false),
                 .shades = round.shades,
                 .frame = input.frame,
                 .motions = system.motions(),
                 .displacement = zero_,
                 .share = share_in(round),
                 .candidates = round.refining ? &refining_candidates_ : nullptr,
                 .skinned = skinned_,
                 .normals = normals_,
                 .moved = system.moved(),
                 .least_moved_px = k > 0 ? float(round.least_moved_px) : -INFINITY,
                 .state = system.look_state()});
    if (k == 0) {
      device_.start();  // and looks while the rounds are prepared
      if (!solver_.begin_rounds(rounds, known)) return std::nullopt;
    }
    SeenVertices seen = known;
    seen.contour = &visibility_.contour();
    seen.matches = &matcher_.matches();
    if (!round.shades) seen.skin.samples = nullptr;
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

double PoseRounds::cost_of(const PoseResult& pose) {
  const double missed_px = options_.rounds.missed_px;
  const double missed = options_.pose.weights.match * pose.missed_weight * missed_px * missed_px;
  if (!(pose.seen_weight > 0)) return pose.energy.total() + missed;
  if (!(first_seen_weight_ > 0)) first_seen_weight_ = pose.seen_weight;
  const double of_first = first_seen_weight_ / pose.seen_weight;
  return pose.energy.total() + (of_first - 1) * pose.energy.match + of_first * missed;
}

// With the vertices that the device chooses of what it has found. skin: what was seen of it.
PoseResult PoseRounds::solve_seen(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin) {
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
PoseResult PoseRounds::solve_read(PoseInput& solve, bool matches, bool shades, std::vector<SkinSample>& skin) {
  if (matches) matcher_.read_later();
  if (shades) shading_.read_later();
  if (solve.frame) visibility_.read_contour_later();
  device_.start();
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
  result.seen_weight = found.seen_weight;
  return result;
}

PoseResult PoseRounds::solve_rough(const PoseStageInput& input, const Pose& initial) {
  find_contour(input, initial);
  const bool has_contour = !input.silhouette.empty();
  const std::vector<int32_t> contour = has_contour ? visibility_.read_contour() : std::vector<int32_t>{};
  return solver_.solve(PoseInput{.detections = input.detections,
                                 .initial = initial,
                                 .frame = has_contour ? &input.frame : nullptr,
                                 .contour_vertices = contour,
                                 .floor = floor_.floor(),
                                 .n_steps = options_.pose.first_steps});
}

}  // namespace livecap
