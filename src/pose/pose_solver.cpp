#include "pose/pose_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace livecap {
namespace {

using KeypointPositions = std::array<Eigen::Vector3d, kKeypointCount>;

// See PoseOptions::damping_own: radians and millimetres have their own largest entry each.
Eigen::VectorXd damping_of(const Eigen::MatrixXd& JtJ, const PoseOptions& options) {
  const Eigen::Index n = JtJ.rows();
  const auto is_angle = [n](Eigen::Index i) { return i < 3 || (i >= 6 && i < n - 3); };
  double largest_angle = 0;
  double largest_length = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    double& largest = is_angle(i) ? largest_angle : largest_length;
    largest = std::max(largest, JtJ(i, i));
  }
  Eigen::VectorXd damping(n);
  for (Eigen::Index i = 0; i < n; ++i)
    damping[i] =
        options.damping_own * JtJ(i, i) + options.damping_largest * (is_angle(i) ? largest_angle : largest_length);
  return damping;
}

// Shortens the whole step so that nothing turns further than the bound.
void limit_turn(Eigen::VectorXd& delta, double max_step_rad) {
  if (max_step_rad <= 0) return;
  const double largest = std::max(delta.head<3>().norm(), delta.segment(6, delta.size() - 9).lpNorm<Eigen::Infinity>());
  if (largest > max_step_rad) delta *= max_step_rad / largest;
}

// Furthest that a keypoint of the actor moves in the picture; infinite for one that is not before the camera.
double moved_px(const Actor& actor, const Camera& camera, const KeypointPositions& from, const KeypointPositions& to) {
  double most = 0;
  for (int k = 0; k < kKeypointCount; ++k) {
    if (actor.keypoints[k].bone < 0) continue;
    if (!(from[k].z() > 0 && to[k].z() > 0)) return INFINITY;
    most = std::max(most, (project_px(camera, to[k]) - project_px(camera, from[k])).norm());
  }
  return most;
}

bool has_observation(const KeypointTargets& targets) {
  return std::any_of(targets.begin(), targets.end(),
                     [](const KeypointTarget& t) { return t.weight_2d > 0 || t.weight_3d > 0; });
}

}  // namespace

DenseSolution damped_step(const PoseNormalEquations& equations, const PoseOptions& options) {
  DenseSolution solution = solve_normal_equations(equations.JtJ, equations.JtF, damping_of(equations.JtJ, options));
  limit_turn(solution.delta, options.max_step_rad);
  return solution;
}

PoseSolver::PoseSolver(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& skin, const Camera& camera,
                       const PoseOptions& options)
    : actor_(actor), camera_(camera), options_(options), system_(device, actor, skin, camera, options) {}

PoseSolver::Prepared PoseSolver::prepare(const PoseInput& input) const {
  Prepared prepared{.targets = make_targets(actor_, input.detections, input.previous, options_),
                    .undoubted_3d = {},
                    .doubt_3d_mm = input.doubt_3d_mm,
                    .stands = {},
                    .keypoints_mm = keypoints(input.initial)};
  weigh_3d(prepared, input);
  if (input.doubt_3d_mm > 0) doubt_far_detections(prepared.targets, prepared.keypoints_mm, input.doubt_3d_mm);
  if (input.floor)
    prepared.stands =
        standing(system_.soles(), actor_.skeleton, *input.floor, input.initial, input.previous, options_.least_stands);
  return prepared;
}

void PoseSolver::weigh_3d(Prepared& prepared, const PoseInput& input) const {
  for (KeypointTarget& target : prepared.targets) target.weight_3d *= input.share_3d;
  for (int k : {kLeftElbow, kRightElbow, kLeftWrist, kRightWrist, kLeftHand, kRightHand})
    prepared.targets[k].weight_3d *= input.arms_3d;
  for (int k : {kLeftKnee, kRightKnee, kLeftAnkle, kRightAnkle, kLeftToe, kRightToe})
    prepared.targets[k].weight_3d *= input.legs_3d;
  for (int k = 0; k < kKeypointCount; ++k) prepared.undoubted_3d[k] = prepared.targets[k].weight_3d;
}

PoseResult PoseSolver::solve(const PoseInput& input, const Prepared& prepared) {
  const KeypointTargets& targets = prepared.targets;
  if (input.seen) {
    system_.set_seen_frame(targets, input.frame, *input.seen);
  } else {
    system_.set_frame(targets, input.frame, input.contour_vertices, input.matches, input.shaded);
  }
  system_.set_floor(input.floor, prepared.stands);
  system_.set_rest(rest_of(input));
  PoseResult result;
  result.pose = input.initial;
  const bool has_detections = has_observation(targets);
  if (!has_detections) system_.read_choice();
  if (!has_detections && system_.n_contour() == 0) {
    result.status = SolveStatus::kNoObservations;
    return result;
  }

  const KeypointPositions& initial = prepared.keypoints_mm;
  const PoseState start{input.initial, best_t_prime(targets, initial)};
  const int n_steps = steps_of(input);
  system_.set_match_px(input.match_px);
  std::optional<PoseSteps> steps = system_.take_steps(start, n_steps, input.settled_px);
  if (!steps) {
    system_.read_choice();
    steps = take_steps(start, n_steps, input.settled_px);
  }
  result.status = steps->status;
  result.step_energy = std::move(steps->step_energy);
  if (result.status != SolveStatus::kOk) return result;
  if (input.seen) {
    result.missed_weight = system_.missed_weight();
    result.seen_weight = system_.seen_weight();
  }
  take(*steps, prepared, result);
  if (result.status == SolveStatus::kOk) result.moved_px = moved_px(actor_, camera_, initial, keypoints(result.pose));
  return result;
}

// Where steps that went well ended.
void PoseSolver::take(const PoseSteps& steps, const Prepared& prepared, PoseResult& result) const {
  measure(steps.state, steps.residuals, prepared, result);
  if (!std::isfinite(result.energy.total())) {
    result.status = SolveStatus::kNotFinite;
    return;
  }
  result.pose = steps.state.pose;
  result.t_prime_mm = steps.state.t_prime_mm;
}

void PoseSolver::start_rounds(const Pose& initial) {
  system_.set_motions(bone_dual_quats(forward_kinematics(actor_.skeleton, initial)));
}

int PoseSolver::steps_of(const PoseInput& input) const {
  return input.n_steps > 0 ? input.n_steps : options_.steps;
}

std::vector<RestAngle> PoseSolver::rest_of(const PoseInput& input) const {
  return rest_angles(actor_, input.detections, input.holds_arms ? input.previous : nullptr, options_);
}

// Doubt, t' and soles at rest of all rounds but the first are the device's to prepare.
bool PoseSolver::begin_rounds(std::span<const Round> rounds, const SeenVertices& known) {
  const PoseInput& first = *rounds.front().input;
  const auto too_long = [&](const Round& round) { return steps_of(*round.input) > LC_POSE_MOST_STEPS; };
  if (std::any_of(rounds.begin(), rounds.end(), too_long)) {
    system_.forget_look();
    return false;
  }
  rounds_.assign(rounds.begin(), rounds.end());
  prepared_.clear();
  std::vector<float> soles_before;
  const std::vector<SolePoint>& soles = system_.soles();
  if (first.previous) {
    const PosedSkeleton before = forward_kinematics(actor_.skeleton, *first.previous);
    for (const SolePoint& sole : soles)
      for (const double value : Eigen::Vector3d(before.camera_from_rest[sole.bone] * sole.rest_mm))
        soles_before.push_back(float(value));
  }
  PoseInput plain = first;
  plain.share_3d = plain.arms_3d = plain.legs_3d = 1;
  plain.doubt_3d_mm = 0;
  const Prepared same = prepare(plain);  // of all rounds
  for (const Round& round : rounds) {
    Prepared prepared = same;
    weigh_3d(prepared, *round.input);
    if (prepared_.empty() && first.doubt_3d_mm > 0)
      doubt_far_detections(prepared.targets, prepared.keypoints_mm, first.doubt_3d_mm);
    prepared.doubt_3d_mm = round.input->doubt_3d_mm;
    system_.set_round(int(prepared_.size()), prepared.targets, known, first.floor, prepared.stands, soles_before);
    prepared_.push_back(std::move(prepared));
  }
  if (!has_observation(prepared_.front().targets)) {
    system_.forget_look();
    return false;
  }
  system_.set_rest(rest_of(first));
  const PoseState start{first.initial, best_t_prime(prepared_.front().targets, prepared_.front().keypoints_mm)};
  system_.begin_rounds(int(rounds.size()), start, first.frame);
  return true;
}

void PoseSolver::launch_round(int round, const SeenVertices& seen) {
  const PoseInput& input = *rounds_[round].input;
  const bool is_followed = std::any_of(rounds_.begin() + round + 1, rounds_.end(),
                                       [](const Round& later) { return !(later.least_moved_px > 0); });
  system_.set_match_px(input.match_px);
  system_.launch_round({.round = round,
                        .n_steps = steps_of(input),
                        .settled_px = input.settled_px,
                        .doubt_3d_mm = input.doubt_3d_mm,
                        .least_moved_px = round > 0 ? float(rounds_[round].least_moved_px) : -INFINITY,
                        .tells = !is_followed},
                       seen);
}

std::optional<PoseResult> PoseSolver::finish_rounds() {
  std::optional<PoseSystem::Rounds> done = system_.read_rounds();
  if (!done) return std::nullopt;
  Prepared& prepared = prepared_[done->round];
  for (int k = 0; k < kKeypointCount; ++k) prepared.targets[k].weight_3d = done->weights_3d[k];
  PoseResult result;
  result.pose = rounds_.front().input->initial;
  result.status = done->steps.status;
  result.step_energy = std::move(done->steps.step_energy);
  if (result.status != SolveStatus::kOk) return result;
  result.missed_weight = system_.missed_weight();
  result.seen_weight = system_.seen_weight();
  result.moved_px = done->moved_px;
  take(done->steps, prepared, result);
  return result;
}

PoseSolver::KeypointPositions PoseSolver::keypoints(const Pose& pose) const {
  return keypoint_positions(actor_, forward_kinematics(actor_.skeleton, pose));
}

// On the host.
PoseSteps PoseSolver::take_steps(const PoseState& start, int n_steps, double settled_px) {
  PoseSteps steps;
  steps.state = start;
  KeypointPositions current = keypoints(start.pose);
  for (int step = 0; step < n_steps; ++step) {
    const PoseNormalEquations equations = system_.assemble(steps.state);
    steps.step_energy.push_back(equations.energy);
    const DenseSolution solution = damped_step(equations, options_);
    steps.status = solution.status;
    if (steps.status != SolveStatus::kOk) return steps;
    steps.state.pose = add_increment(steps.state.pose, solution.delta.head(solution.delta.size() - 3));
    steps.state.t_prime_mm += solution.delta.tail<3>();
    if (!(settled_px > 0)) continue;
    const KeypointPositions before = std::exchange(current, keypoints(steps.state.pose));
    if (moved_px(actor_, camera_, before, current) < settled_px) break;
  }
  steps.residuals = system_.residuals(steps.state);
  return steps;
}

void PoseSolver::measure(const PoseState& state, std::span<const float> residuals, const Prepared& prepared,
                         PoseResult& result) const {
  const KeypointTargets& targets = prepared.targets;
  const auto energy = [&](int first, int n) {
    double sum = 0;
    for (int i = first; i < first + n; ++i) sum += double(residuals[i]) * residuals[i];
    return sum;
  };
  for (int k = 0; k < kKeypointCount; ++k) {
    const int row = k * LC_POSE_ROWS_PER_KEYPOINT;
    result.energy.keypoint_2d += energy(row + LC_POSE_ROW_2D, 2);
    if (targets[k].weight_3d > 0)
      result.energy.keypoint_3d +=
          prepared.undoubted_3d[k] *
          doubted_cost(energy(row + LC_POSE_ROW_3D, 3) / targets[k].weight_3d, prepared.doubt_3d_mm);
    const double temporal = energy(row + LC_POSE_ROW_TEMPORAL, 3);
    result.energy.temporal += temporal;
    if (targets[k].weight_temporal > 0)
      result.energy.doubted_temporal +=
          targets[k].weight_temporal * doubted_cost(temporal / targets[k].weight_temporal, options_.temporal_doubt_mm);
  }
  const int n_dofs = actor_.skeleton.n_dofs(), n_soles = int(system_.soles().size());
  result.energy.anatomic = energy(LC_POSE_POINT_ROWS, n_dofs);
  result.energy.rest = energy(LC_POSE_POINT_ROWS + n_dofs, n_dofs);
  result.energy.floor = energy(LC_POSE_POINT_ROWS + 2 * n_dofs, n_soles);
  result.energy.silhouette = energy(system_.n_point_rows(), system_.n_contour());
  result.energy.match = energy(system_.n_point_rows() + system_.n_contour(), 2 * system_.n_matches());
  result.energy.shading = energy(system_.n_rows() - system_.n_shaded(), system_.n_shaded());

  const KeypointPositions positions = keypoints(state.pose);
  double error_px = 0;
  double weight = 0;
  for (int k = 0; k < kKeypointCount; ++k) {
    const Eigen::Vector3d& p = positions[k];
    if (!(targets[k].weight_2d > 0) || !(p.z() > 0)) continue;
    error_px += targets[k].weight_2d * (project_px(camera_, p) - targets[k].position_px).norm();
    weight += targets[k].weight_2d;
  }
  result.keypoint_error_px = weight > 0 ? error_px / weight : 0;
}

}  // namespace livecap
