// Known-answer test of the pose stage's kernels: a two-bone actor, its residuals in double on the host, and their
// central differences as Jacobian.
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/text.h"
#include "geometry/reference.h"
#include "match/layout.h"
#include "pose/pose_solver.h"
#include "shared/seen_weight.h"

namespace livecap {
namespace {

constexpr double kRelative = 1e-4;  // float rows against double central differences
constexpr double kStepMm = 100;     // of a Gauss-Newton step, beside a radian

Actor two_bone_actor() {
  Actor actor;
  actor.skeleton.bones = {{"root", -1, {0, 0, 0}}, {"left_ankle", 0, {200, 0, 0}}};  // a sole of vertex 2 alone
  actor.skeleton.dofs = {{"arm_z", 1, {0, 0, 1}, -0.2, 0.2, 0.1, 0.5}};
  actor.mesh.positions = {0, 0, 0, 200, 50, 0, 400, 0, 10, 200, -50, 0, 200, 0, 60};
  actor.mesh.triangles = {0, 4, 1, 1, 4, 2, 2, 4, 3, 3, 4, 0};
  actor.skin.bones = {0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
  actor.skin.weights = {1, 0, 0, 0, 0.75f, 0.25f, 0, 0, 1, 0, 0, 0, 0.625f, 0.375f, 0, 0, 0.5f, 0.5f, 0, 0};
  actor.keypoints[kPelvis] = {0, {0, 0, 0}};
  actor.keypoints[kNeck] = {1, {350, 20, 5}};
  return actor;
}

reference::Vec3 to_vec3(const Eigen::Vector3d& v) {
  return reference::vec3(v.x(), v.y(), v.z());
}

// The host's rows. The distance image is the plane 60 - 0.5 u + 0.25 v: positive for every vertex, so that b is 1 or 0.
Eigen::VectorXd host_rows(const Actor& actor, const Camera& camera, const PoseOptions& options,
                          const KeypointTargets& targets, const std::vector<VertexMatch>& matches,
                          const std::vector<ShadedVertex>& shaded, const Floor& floor, double stands,
                          const PoseState& state) {
  const reference::Pinhole cam{camera.fx, camera.fy, camera.cx, camera.cy};
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, state.pose);
  const auto positions = keypoint_positions(actor, posed);
  std::vector<double> rows;
  for (int k = 0; k < kKeypointCount; ++k) {
    const KeypointTarget& t = targets[k];
    const reference::Vec3 p = to_vec3(positions[k]);
    const auto r2 = reference::keypoint_2d_row(p, cam, {t.position_px.x(), t.position_px.y()});
    const auto r3 = reference::keypoint_3d_row(p, to_vec3(state.t_prime_mm), to_vec3(t.detection_mm));
    const auto rt = reference::temporal_row(p, to_vec3(t.previous_position_mm));
    for (double r : r2.r) rows.push_back(t.weight_2d > 0 ? std::sqrt(t.weight_2d) * r : 0);
    for (double r : r3.r) rows.push_back(std::sqrt(t.weight_3d) * r);
    for (double r : rt.r) rows.push_back(std::sqrt(t.weight_temporal) * r);
  }
  const Dof& dof = actor.skeleton.dofs[0];
  rows.push_back(std::sqrt(options.weights.anatomic) *
                 reference::anatomic_row(state.pose.angles_rad[0], dof.min_rad, dof.max_rad).r);
  rows.push_back(std::sqrt(options.weights.rest * dof.rest_share) *
                 reference::rest_row(state.pose.angles_rad[0], dof.rest_rad).r);
  for (const SolePoint& sole : sole_points(actor)) {
    const reference::Vec3 p = to_vec3(posed.camera_from_rest[sole.bone] * sole.rest_mm);
    rows.push_back(std::sqrt(options.weights.floor) *
                   reference::floor_row(p, to_vec3(floor.up), floor.offset_mm, stands).r);
  }
  const auto blend = [&](int i) {
    reference::DualQuat q = reference::dual_quat_zero();
    for (int j = 0; j < 4; ++j) {
      const Eigen::Isometry3d& motion = posed.camera_from_rest[actor.skin.bones[4 * i + j]];
      const Eigen::Quaterniond real(motion.linear());
      const Eigen::Vector3d t = motion.translation() / 2;
      const Eigen::Quaterniond dual = Eigen::Quaterniond(0, t.x(), t.y(), t.z()) * real;
      q = reference::dual_quat_add_scaled(
          q, {real.w(), real.x(), real.y(), real.z(), dual.w(), dual.x(), dual.y(), dual.z()},
          actor.skin.weights[4 * i + j]);
    }
    return q;
  };
  const auto skinned = [&](int i) {
    const float* rest = &actor.mesh.positions[3 * i];
    return reference::dual_quat_transform(blend(i), reference::vec3(rest[0], rest[1], rest[2]));
  };
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const reference::Vec2 uv = reference::project_point(skinned(i), cam).uv;
    rows.push_back(std::sqrt(options.weights.silhouette) * (60 - 0.5 * uv.x + 0.25 * uv.y));
  }
  for (const VertexMatch& m : matches) {
    const auto row = reference::match_row(skinned(m.vertex), cam, {m.u_px, m.v_px}, m.a, m.b, m.c);
    for (double r : row.r) rows.push_back(std::sqrt(options.weights.match * m.weight) * r);
  }
  const std::vector<float> normals = vertex_normals(actor.mesh.positions, actor.mesh.triangles);
  for (const ShadedVertex& s : shaded) {
    const float* rest = &normals[3 * s.vertex];
    reference::Harmonics light;
    std::copy(s.light.begin(), s.light.end(), light.of);
    const auto n = reference::dual_quat_rotate(blend(s.vertex), reference::vec3(rest[0], rest[1], rest[2]));
    rows.push_back(std::sqrt(options.weights.shading * s.weight) * reference::shading_row(n, light, s.brightness).r);
  }
  return Eigen::Map<Eigen::VectorXd>(rows.data(), rows.size());
}

PoseState moved(const PoseState& state, const Eigen::VectorXd& step) {
  return {add_increment(state.pose, step.head(step.size() - 3)), state.t_prime_mm + step.tail<3>()};
}

// Largest difference relative to the largest expected value, as a result line.
ocl::SelfTestResult compare(const std::string& kernels, const Eigen::MatrixXd& got, const Eigen::MatrixXd& expected) {
  ocl::SelfTestResult result{kernels, true, {}};
  const double scale = std::max(1.0, expected.cwiseAbs().maxCoeff());
  const double error = got.allFinite() ? (got - expected).cwiseAbs().maxCoeff() / scale : INFINITY;
  if (error > kRelative) {
    result.ok = false;
    result.detail = format("relative difference %g from the host's double, at most %g expected", error, kRelative);
  }
  return result;
}

// From one state to the other: turns in rad, lengths in kStepMm.
Eigen::VectorXd step_between(const PoseState& from, const PoseState& to) {
  Eigen::VectorXd step(from.pose.angles_rad.size() + 9);
  step << vector_from_rotation(to.pose.root_rotation * from.pose.root_rotation.transpose()),
      to.pose.angles_rad - from.pose.angles_rad,
      (to.pose.root_translation_mm - from.pose.root_translation_mm) / kStepMm,
      (to.t_prime_mm - from.t_prime_mm) / kStepMm;
  return step;
}

// Rows of what the device chose of pictures' vertices against those of what the host chose of the same.
ocl::SelfTestResult check_choice(ocl::DeviceContext& device, PoseSystem& system, const KeypointTargets& targets,
                                 const DeviceFrame& frame, const PoseState& state) {
  constexpr float kMatchArea = 25, kLimbArea = 400;
  SeenVertices seen;
  const ocl::Buffer<int32_t> contour(device, {1, 0, 1, 0, 1}), skin_vertices(device, {1, 4}), limbs(device, {0, 3});
  std::vector<float> matches(5 * LC_MATCH, 0.0f), skin(2 * LC_SKIN, 0.0f);
  std::vector<VertexMatch> found;
  std::vector<ShadedVertex> shaded;
  for (const int i : {1, 3}) {
    float* m = &matches[size_t(LC_MATCH) * i];
    for (int k = 0; k < 5; ++k) m[k] = 20 + 3 * k - i;
    m[LC_MATCH_WEIGHT_PX] = 10 * i;
    m[LC_MATCH_SEEN_PX] = 40;
    found.push_back({i, m[0], m[1], m[2], m[3], m[4], seen_weight(m[LC_MATCH_WEIGHT_PX], kMatchArea)});
  }
  for (int i = 0; i < 2; ++i) {
    skin[LC_SKIN * i + LC_SKIN_BRIGHTNESS] = 0.5f + i;
    skin[LC_SKIN * i + LC_SKIN_PX] = 300 + 200 * i;
    seen.skin.lights[i] = {true, {0.5f, 0.25f, -1, 0.5f, 0.125f * i}, 0.1};
    shaded.push_back({i == 0 ? 1 : 4, seen.skin.lights[i].light, in_deviations(0.5f + i, 0.1),
                      seen_weight(300 + 200 * i, std::max(300 + 200 * i, int(kLimbArea)))});
  }
  const ocl::Buffer<float> match_buffer(device, matches), skin_buffer(device, skin);
  seen = {&contour, &match_buffer, kMatchArea, {&skin_buffer, &skin_vertices, &limbs, kLimbArea, seen.skin.lights}};
  // First the device, so that it does not find the host's choice.
  system.set_seen_frame(targets, &frame, seen);
  system.read_choice();
  const std::vector<float> chosen = system.residuals(state);
  system.set_frame(targets, &frame, std::vector<int32_t>{0, 2, 4}, found, shaded);
  ocl::SelfTestResult result{"pose/choose.cl pose_choose", system.residuals(state) == chosen, {}};
  if (!result.ok) result.detail = "it chooses other vertices than the host, or weighs them otherwise";
  return result;
}

}  // namespace

std::vector<ocl::SelfTestResult> pose_self_test(ocl::DeviceContext& device) {
  const Actor actor = two_bone_actor();
  const Camera camera = camera_from_fov(64, 48, 60);
  PoseOptions options;
  options.keypoint_2d_huber_px = options.silhouette_huber_px = options.match_huber_px = options.shading_huber =
      options.floor_huber_mm = 0;  // the expected rows are quadratic
  PoseState state;
  state.pose.root_rotation = rotation_from_vector({0.1, -0.2, 0.3});
  state.pose.root_translation_mm = {-180, 10, 1500};
  state.pose.angles_rad = Eigen::VectorXd::Constant(1, 0.5);
  state.t_prime_mm = {5, 6, 1400};
  KeypointTargets targets;
  targets[kPelvis] = {{20, 30}, {1, 2, 3}, {4, 5, 1480}, 460, 28, 3};
  targets[kNeck] = {{40, 20}, {300, 0, 20}, {100, 5, 1490}, 200, 10, 2};

  DeviceFrame frame(device, camera.width, camera.height);
  std::vector<float> distance;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) distance.push_back(60.0f - 0.5f * u + 0.25f * v);
  frame.signed_distance.write(distance);
  const std::vector<int32_t> contour = {0, 1, 2, 3, 4};

  PoseSystem system(device, actor, camera, options);
  const std::vector<VertexMatch> matches = {{1, 30, 20, 1, 0.5f, 0.25f, 2}, {3, 25, 40, 0.5f, 0, 1, 1}};
  const std::vector<ShadedVertex> shaded = {{1, {0.5f, 0.25f, -1, 0.5f, 0.125f, 0.25f, -0.5f, 0.75f, 0.25f}, 0.5f, 2},
                                            {4, {0, 1, -2, 0.5f}, -0.25f, 1}};
  system.set_frame(targets, &frame, contour, matches, shaded);
  const Floor floor{Eigen::Vector3d(0.6, -0.8, 0), -40};
  const double stands = 0.5;
  system.set_floor(&floor, std::vector<double>{stands});
  const std::vector<float> rows = system.residuals(state);
  const Eigen::VectorXd F = Eigen::Map<const Eigen::VectorXf>(rows.data(), rows.size()).cast<double>();
  const Eigen::MatrixXd J = system.jacobian(state).cast<double>();
  const PoseNormalEquations equations = system.assemble(state);

  const Eigen::VectorXd expected_F = host_rows(actor, camera, options, targets, matches, shaded, floor, stands, state);
  Eigen::MatrixXd expected_J(F.size(), system.n_unknowns());
  for (int k = 0; k < system.n_unknowns(); ++k) {
    const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(system.n_unknowns(), k);
    expected_J.col(k) =
        (host_rows(actor, camera, options, targets, matches, shaded, floor, stands, moved(state, step)) -
         host_rows(actor, camera, options, targets, matches, shaded, floor, stands, moved(state, -step))) /
        2e-5;
  }
  expected_J.row(system.n_point_rows() + 3).setZero();  // its normal points down the plane: b = 0
  std::vector<ocl::SelfTestResult> results;
  const PoseState expected_step = moved(state, damped_step(equations, options).delta);
  if (const std::optional<PoseSteps> step = system.take_steps(state, 1, 0))
    results.push_back(compare("pose/gauss_newton.cl pose_gauss_newton", step_between(state, step->state),
                              step_between(state, expected_step)));

  const int n = system.n_point_rows();
  const int m = system.n_contour();
  const int k = 2 * system.n_matches();
  for (const ocl::SelfTestResult& result :
       {compare("pose/point_records.cl pose_point_records", F.head(n), expected_F.head(n)),
        compare("pose/contour_records.cl pose_contour_records", F.segment(n, m), expected_F.segment(n, m)),
        compare("pose/match_records.cl pose_match_records", F.segment(n + m, k), expected_F.segment(n + m, k)),
        compare("pose/shading_records.cl pose_shading_records", F.tail(F.size() - n - m - k),
                expected_F.tail(F.size() - n - m - k)),
        compare("pose/fill_rows.cl pose_fill_point_rows", J.topRows(n), expected_J.topRows(n)),
        compare("pose/fill_rows.cl pose_fill_skinned_rows", J.bottomRows(J.rows() - n),
                expected_J.bottomRows(J.rows() - n)),
        compare("pose/gram.cl pose_gram", equations.JtJ, expected_J.transpose() * expected_J)})
    results.push_back(result);
  if (system.chooses()) results.push_back(check_choice(device, system, targets, frame, state));
  return results;
}

}  // namespace livecap
