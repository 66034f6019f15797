#include "eigen_pose.h"

#include <algorithm>
#include <cmath>

#define REAL float
#define LC_FN inline
#define LC_LIT(x) float(x)
#define LC_SQRT(x) std::sqrt(x)
#define LC_FABS(x) std::fabs(x)
#define LC_UNROLL

namespace livecap::bench {
namespace {

#include "pose/skinned_gradient.h"
//
#include "pose/huber.h"
#include "terms/anatomic.cl"
#include "terms/keypoint_2d.cl"
#include "terms/keypoint_3d.cl"
#include "terms/rest.cl"
#include "terms/silhouette.cl"
#include "terms/temporal.cl"

Vec3 vec3_at(const float* p) {
  return vec3(p[0], p[1], p[2]);
}

Vec3 vec3_of(const Eigen::Vector3d& p) {
  return vec3(float(p.x()), float(p.y()), float(p.z()));
}

Pinhole pinhole_of(const Camera& camera) {
  return {float(camera.fx), float(camera.fy), float(camera.cx), float(camera.cy)};
}

// What a wrench does along every column: axis . torque + moment . force. planes: of the step, see pose/layout.h.
auto along_columns(const Wrench& w, const auto& planes) {
  return w.torque.x * planes.row(0) + w.torque.y * planes.row(1) + w.torque.z * planes.row(2) +
         w.force.x * planes.row(3) + w.force.y * planes.row(4) + w.force.z * planes.row(5);
}

}  // namespace

EigenPose::EigenPose(const Actor& actor, const Camera& camera, const PoseOptions& options)
    : actor_(actor),
      camera_(camera),
      options_(options),
      points_{actor.skeleton, actor.keypoints, {}},
      rest_normals_(vertex_normals(actor.mesh.positions, actor.mesh.triangles)) {
  layout_.n_dofs = actor.skeleton.n_dofs();
  layout_.n_unknowns = layout_.n_dofs + 9;
  layout_.n_columns = (layout_.n_unknowns + 8) / 8 * 8;
  layout_.n_bones = actor.skeleton.n_bones();
  moves_ = Rows::Zero(layout_.n_bones, layout_.n_columns);
  moves_.leftCols(6) = 1;
  const std::vector<uint64_t> masks = dofs_moving_bones(actor.skeleton);
  for (int b = 0; b < layout_.n_bones; ++b)
    for (int k = 0; k < layout_.n_dofs; ++k) moves_(b, 6 + k) = float(masks[b] >> k & 1);
  step_.resize(LC_POSE_STEP_SIZE(layout_));
  J_.resize(LC_POSE_POINT_ROWS + 2 * layout_.n_dofs + options.max_contour_vertices, layout_.n_columns);
  gram_.resize(layout_.n_columns, layout_.n_columns);
}

EigenPose::Result EigenPose::solve(const PoseInput& input, const std::vector<float>& distance) {
  const KeypointTargets targets = make_targets(actor_, input.detections, input.previous, options_);
  const PosedSkeleton initial = forward_kinematics(actor_.skeleton, input.initial);
  PoseState state{input.initial, best_t_prime(targets, keypoint_positions(actor_, initial))};
  for (int i = 0; i < options_.steps; ++i) {
    write_step(layout_, points_, state, step_);
    fill_rows(input, targets, distance, true);
    take_step(state);
  }
  write_step(layout_, points_, state, step_);
  fill_rows(input, targets, distance, false);
  return {state, double(J_.col(layout_.n_unknowns).head(n_rows_).square().sum())};
}

// Rows without weight are left out.
void EigenPose::fill_rows(const PoseInput& input, const KeypointTargets& targets, const std::vector<float>& distance,
                          bool with_J) {
  n_rows_ = 0;
  for (int k = 0; k < kKeypointCount; ++k) add_keypoint(k, targets[k], with_J);
  const float sqrt_anatomic = float(std::sqrt(options_.weights.anatomic));
  for (int k = 0; k < layout_.n_dofs; ++k) {
    const Dof& dof = actor_.skeleton.dofs[k];
    const AnatomicRow a = anatomic_row(step_[LC_POSE_STEP_ANGLES(layout_) + k], float(dof.min_rad), float(dof.max_rad));
    if (a.J == 0) continue;
    auto row = J_.row(n_rows_++);
    row = 0;
    row[6 + k] = sqrt_anatomic * a.J;
    row[layout_.n_unknowns] = sqrt_anatomic * a.r;
  }
  for (int k = 0; k < layout_.n_dofs; ++k) {
    const Dof& dof = actor_.skeleton.dofs[k];
    const float sqrt_rest = float(std::sqrt(options_.weights.rest * dof.rest_share));
    if (sqrt_rest == 0) continue;
    const RestRow a = rest_row(step_[LC_POSE_STEP_ANGLES(layout_) + k], float(dof.rest_rad));
    auto row = J_.row(n_rows_++);
    row = 0;
    row[6 + k] = sqrt_rest * a.J;
    row[layout_.n_unknowns] = sqrt_rest * a.r;
  }
  const float sqrt_silhouette = float(std::sqrt(options_.weights.silhouette));
  for (const int vertex : input.contour_vertices) add_contour_vertex(vertex, distance.data(), sqrt_silhouette, with_J);
}

void EigenPose::add_keypoint(int k, const KeypointTarget& target, bool with_J) {
  const Eigen::Map<const Rows> planes(step_.data(), 6, layout_.n_columns);
  const Vec3 p = vec3_at(&step_[LC_POSE_STEP_KEYPOINTS(layout_) + 3 * k]);
  const Vec3 p_camera = add3(p, vec3_at(&step_[LC_POSE_STEP_ROOT(layout_)]));
  const int bone = std::max(actor_.keypoints[k].bone, 0);
  const auto add = [&](float s, float r, const float* J) {
    auto row = J_.row(n_rows_++);
    if (with_J) row = moves_.row(bone) * along_columns(point_wrench(p, scale3(vec3_at(J), s)), planes);
    row[layout_.n_unknowns] = s * r;
  };
  if (target.weight_2d > 0 && p_camera.z > LC_MIN_DEPTH_MM) {
    const Vec2 px = {float(target.position_px.x()), float(target.position_px.y())};
    const Keypoint2dRow a = keypoint_2d_row(p_camera, pinhole_of(camera_), px);
    const float s = float(std::sqrt(target.weight_2d)) *
                    huber_factor(std::hypot(a.r[0], a.r[1]), float(options_.keypoint_2d_huber_px));
    for (int j = 0; j < 2; ++j) add(s, a.r[j], a.J[j]);
  }
  if (target.weight_3d > 0) {
    const Keypoint3dRow a =
        keypoint_3d_row(p_camera, vec3_at(&step_[LC_POSE_STEP_T_PRIME(layout_)]), vec3_of(target.detection_mm));
    const float s = float(std::sqrt(target.weight_3d));
    for (int j = 0; j < 3; ++j) {
      add(s, a.r[j], a.J[j]);
      for (int i = 0; i < 3; ++i) J_(n_rows_ - 1, layout_.n_unknowns - 3 + i) = s * a.J[j][3 + i];
    }
  }
  if (target.weight_temporal > 0) {
    const TemporalRow a = temporal_row(p_camera, vec3_of(target.previous_position_mm));
    for (int j = 0; j < 3; ++j) add(float(std::sqrt(target.weight_temporal)), a.r[j], a.J[j]);
  }
}

void EigenPose::add_contour_vertex(int vertex, const float* distance, float sqrt_weight, bool with_J) {
  const int32_t* bones = &actor_.skin.bones[4 * size_t(vertex)];
  const float* weights = &actor_.skin.weights[4 * size_t(vertex)];
  const Vec3 rest = vec3_at(&actor_.mesh.positions[3 * size_t(vertex)]);
  DualQuat parts[4], blend = dual_quat_zero(), first = blend;
  int n_parts = 0;
  for (; n_parts < 4 && weights[n_parts] != 0; ++n_parts) {
    const float* q = &step_[LC_POSE_STEP_DUAL_QUATS(layout_) + 8 * bones[n_parts]];
    const DualQuat turn = {q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7]};
    if (n_parts == 0) first = turn;
    const float sign = dual_quat_real_dot(first, turn) < 0 ? -1.0f : 1.0f;
    parts[n_parts] = dual_quat_add_scaled(dual_quat_zero(), turn, sign * weights[n_parts]);
    blend = dual_quat_add_scaled(blend, parts[n_parts], 1);
  }
  const Vec3 p = dual_quat_transform(blend, rest);
  const Vec3 p_camera = add3(p, vec3_at(&step_[LC_POSE_STEP_ROOT(layout_)]));
  const Projection projection = project_point(p_camera, pinhole_of(camera_));
  const Vec2 uv = projection.uv;
  if (!(p_camera.z > LC_MIN_DEPTH_MM && uv.x >= 0 && uv.x <= float(camera_.width - 1) && uv.y >= 0 &&
        uv.y <= float(camera_.height - 1)))
    return;

  const int x = std::min(int(uv.x), camera_.width - 2), y = std::min(int(uv.y), camera_.height - 2);
  const float fx = uv.x - float(x), fy = uv.y - float(y);
  const float *upper = distance + size_t(y) * camera_.width + x, *lower = upper + camera_.width;
  const float top = upper[0] + fx * (upper[1] - upper[0]), bottom = lower[0] + fx * (lower[1] - lower[0]);
  const Vec2 gradient = {(1 - fy) * (upper[1] - upper[0]) + fy * (lower[1] - lower[0]), bottom - top};
  const float value = top + fy * (bottom - top);
  const Vec3 normal = dual_quat_rotate(blend, vec3_at(&rest_normals_[3 * size_t(vertex)]));
  const Vec2 normal_px = {projection.J[0][0] * normal.x + projection.J[0][2] * normal.z,
                          projection.J[1][1] * normal.y + projection.J[1][2] * normal.z};
  const SilhouetteRow a =
      silhouette_row(p_camera, pinhole_of(camera_), value, gradient, silhouette_direction(value, gradient, normal_px));
  const float s = sqrt_weight * huber_factor(std::fabs(a.r), float(options_.silhouette_huber_px));
  auto row = J_.row(n_rows_++);
  if (with_J) {
    const Eigen::Map<const Rows> planes(step_.data(), 6, layout_.n_columns);
    const DualQuat c = dual_quat_transform_gradient(blend, rest, p, scale3(vec3_at(a.J), s));
    row = moves_.row(bones[0]) * along_columns(dual_quat_turn_wrench(c, parts[0]), planes);
    for (int j = 1; j < n_parts; ++j)
      row += moves_.row(bones[j]) * along_columns(dual_quat_turn_wrench(c, parts[j]), planes);
  }
  row[layout_.n_unknowns] = s * a.r;
}

void EigenPose::take_step(PoseState& state) {
  const int n = layout_.n_unknowns;
  gram_.setZero();
  gram_.selfadjointView<Eigen::Lower>().rankUpdate(J_.topRows(n_rows_).matrix().transpose());
  A_ = gram_.topLeftCorner(n, n).cast<double>();
  const auto diagonal = A_.diagonal().array();
  const auto is_angle = [n](int i) { return i < 3 || (i >= 6 && i < n - 3); };
  double largest[2] = {0, 0};
  for (int i = 0; i < n; ++i) largest[is_angle(i)] = std::max(largest[is_angle(i)], diagonal[i]);
  for (int i = 0; i < n; ++i)
    A_(i, i) += options_.damping_own * A_(i, i) + options_.damping_largest * largest[is_angle(i)];
  delta_ = -gram_.row(n).head(n).transpose().cast<double>();
  cholesky_.compute(A_);
  cholesky_.solveInPlace(delta_);
  const double turn = std::max(delta_.head<3>().norm(), delta_.segment(6, n - 9).lpNorm<Eigen::Infinity>());
  if (turn > options_.max_step_rad) delta_ *= options_.max_step_rad / turn;
  state.pose = add_increment(state.pose, delta_.head(n - 3));
  state.t_prime_mm += delta_.tail<3>();
}

}  // namespace livecap::bench
