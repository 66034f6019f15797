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
  for (int k : {kLeftElbow, kRightElbow, kLeftWrist, kRightWrist, kLeftHand, kRightHand})
    prepared.targets[k].weight_3d *= input.arms_3d;
  for (int k = 0; k < kKeypointCount; ++k) prepared.undoubted_3d[k] = prepared.targets[k].weight_3d;
  if (input.doubt_3d_mm > 0) doubt_far_detections(prepared.targets, prepared.keypoints_mm, input.doubt_3d_mm);
  if (input.floor)
    prepared.stands = standing(system_.soles(), actor_.skeleton, *input.floor, input.initial, input.previous);
  return prepared;
}

PoseResult PoseSolver::solve(const PoseInput& input, const Prepared& prepared) {
  const KeypointTargets& targets = prepared.targets;
  if (input.seen) {
    system_.set_seen_frame(targets, input.frame, *input.seen, input.displacement_rest);
  } else {
    system_.set_frame(targets, input.frame, input.contour_vertices, input.displacement_rest, input.matches,
                      input.shaded);
  }
  system_.set_floor(input.floor, prepared.stands);
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
  const int n_steps = input.n_steps > 0 ? input.n_steps : options_.steps;
  std::optional<PoseSteps> steps = system_.take_steps(start, n_steps, input.settled_px);
  if (!steps) {
    system_.read_choice();
    steps = take_steps(start, n_steps, input.settled_px);
  }
  result.status = steps->status;
  result.step_energy = std::move(steps->step_energy);
  if (result.status != SolveStatus::kOk) return result;
  result.missed_weight = input.seen ? system_.missed_weight() : 0;
  measure(steps->state, steps->residuals, prepared, result);
  if (!std::isfinite(result.energy.total())) {
    result.status = SolveStatus::kNotFinite;
    return result;
  }
  result.pose = steps->state.pose;
  result.t_prime_mm = steps->state.t_prime_mm;
  result.moved_px = moved_px(actor_, camera_, initial, keypoints(result.pose));
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

void PoseSolver::measure(const PoseState& state, const PoseResiduals& residuals, const Prepared& prepared,
                         PoseResult& result) const {
  const KeypointTargets& targets = prepared.targets;
  const auto energy = [&](int first, int n) {
    double sum = 0;
    for (int i = first; i < first + n; ++i) sum += double(residuals.rows[i]) * residuals.rows[i];
    return sum;
  };
  for (int k = 0; k < kKeypointCount; ++k) {
    const int row = k * LC_POSE_ROWS_PER_KEYPOINT;
    result.energy.keypoint_2d += energy(row + LC_POSE_ROW_2D, 2);
    if (targets[k].weight_3d > 0)
      result.energy.keypoint_3d +=
          prepared.undoubted_3d[k] *
          doubted_cost(energy(row + LC_POSE_ROW_3D, 3) / targets[k].weight_3d, prepared.doubt_3d_mm);
    result.energy.temporal += energy(row + LC_POSE_ROW_TEMPORAL, 3);
  }
  const int n_dofs = actor_.skeleton.n_dofs(), n_soles = int(system_.soles().size());
  result.energy.anatomic = energy(LC_POSE_POINT_ROWS, n_dofs);
  result.energy.floor = energy(LC_POSE_POINT_ROWS + n_dofs, n_soles);
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

  double distance_px = 0;
  for (int i = 0; i < system_.n_contour(); ++i) {
    if (std::isnan(residuals.distances_px[i])) continue;
    ++result.n_contour_visible;
    distance_px += std::abs(residuals.distances_px[i]);
  }
  result.silhouette_error_px = result.n_contour_visible > 0 ? distance_px / result.n_contour_visible : 0;
}

}  // namespace livecap
