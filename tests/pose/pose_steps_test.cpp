// All Gauss-Newton steps of a solve in one launch (kernels/pose/gauss_newton.cl) against one by one with the host's
// forward kinematics and solver.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "pose/pose_solver.h"
#include "support/gpu_bodies.h"
#include "support/pose_reference.h"
#include "support/pose_scene.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// With this many joints less; or more, each beside another one, so that something tells them apart.
Actor actor_with(int n_more_joints) {
  Actor actor = test::make_test_actor(0.7);
  std::vector<Dof>& dofs = actor.skeleton.dofs;
  for (; n_more_joints < 0; ++n_more_joints) dofs.pop_back();
  for (int k = 0; k < n_more_joints; ++k) {
    Dof another = dofs[2 * k];
    another.axis = Eigen::Vector3d(another.axis.z(), another.axis.x(), another.axis.y());
    dofs.push_back(another);
  }
  return actor;
}

// A pose near the truth with rows of every kind.
struct StepsScene {
  Actor actor;
  Camera camera = test::portrait_camera();
  PoseOptions options;
  std::mt19937 rng{23};
  Pose truth = test::random_true_pose(actor, rng, 0.6);
  Pose previous = test::disturbed(truth, rng, 0.05, 20);
  Detections detections = test::exact_detections(actor, camera, truth, 0.9);
  PoseState start{test::disturbed(truth, rng, 0.15, 40), {20, -40, 3100}};
  std::vector<int32_t> contour = test::some_vertices(actor, 3);
  std::vector<VertexMatch> matches;
  std::vector<ShadedVertex> shaded;
  Floor floor{-Eigen::Vector3d::UnitY(), 900};
  DeviceFrame frame;

  explicit StepsScene(ocl::DeviceContext& device, int n_more_joints = 0)
      : actor(actor_with(n_more_joints)), frame(device, camera.width, camera.height) {
    std::vector<float> distance = test::smooth_distance(camera);
    for (float& value : distance) value *= 0.01f;  // pulls no harder than the rest
    frame.signed_distance.write(distance);
    for (int i = 0; i < 37; ++i) {
      const Keypoint keypoint = Keypoint(i % kKeypointCount);
      const KeypointDetection& seen = detections.keypoints[keypoint];
      matches.push_back({.vertex = 7 * i % actor.n_vertices(), .u_px = seen.x_px, .v_px = seen.y_px, .weight = 0.01f});
      shaded.push_back(
          {.vertex = 11 * i % actor.n_vertices(), .light = {0.5f, 1, 2}, .brightness = 0.1f * float(i % 5)});
    }
  }
  void give(PoseSystem& system) const {
    system.set_frame(make_targets(actor, detections, &previous, options), &frame, contour, matches, shaded);
    system.set_floor(&floor, std::vector<double>(system.soles().size(), 0.5));
  }
};

struct ByTheHost {
  std::vector<PoseState> states;  // before each step, and at the end
  std::vector<double> energy;     // before each step
};

ByTheHost steps_by_the_host(PoseSystem& system, const StepsScene& scene, int n_steps) {
  ByTheHost steps{{scene.start}, {}};
  for (int step = 0; step < n_steps; ++step) {
    const PoseNormalEquations equations = system.assemble(steps.states.back());
    const DenseSolution solution = damped_step(equations, scene.options);
    EXPECT_EQ(solution.status, SolveStatus::kOk);
    const PoseState& at = steps.states.back();
    steps.energy.push_back(equations.energy);
    steps.states.push_back({add_increment(at.pose, solution.delta.head(solution.delta.size() - 3)),
                            at.t_prime_mm + solution.delta.tail<3>()});
  }
  return steps;
}

void expect_same(const PoseState& got, const PoseState& expected) {
  EXPECT_LT((got.pose.angles_rad - expected.pose.angles_rad).lpNorm<Eigen::Infinity>(), test::kStepsRad);
  EXPECT_LT((got.pose.root_rotation - expected.pose.root_rotation).lpNorm<Eigen::Infinity>(), test::kStepsRad);
  EXPECT_LT((got.pose.root_translation_mm - expected.pose.root_translation_mm).norm(), test::kStepsMm);
  EXPECT_LT((got.t_prime_mm - expected.t_prime_mm).norm(), test::kStepsMm);
}

TEST(PoseSteps, AreTheHosts) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    StepsScene scene(device);
    scene.options.max_step_rad = 0.1;  // shortens the first ones
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    scene.give(system);
    constexpr int kSteps = 6;
    const ByTheHost expected = steps_by_the_host(system, scene, kSteps);
    for (int n : {0, 1, kSteps}) {
      const std::optional<PoseSteps> got = system.take_steps(scene.start, n, 0);
      ASSERT_TRUE(got.has_value());
      EXPECT_EQ(got->status, SolveStatus::kOk);
      ASSERT_EQ(got->step_energy.size(), size_t(n));
      for (int i = 0; i < n; ++i)
        EXPECT_NEAR(got->step_energy[i], expected.energy[i], test::kPoseJacobian * expected.energy[i]) << n << " " << i;
      expect_same(got->state, expected.states[n]);
      const std::vector<float> residuals = system.residuals(got->state);
      EXPECT_EQ(got->residuals, residuals);
    }
    EXPECT_LT(expected.energy.back(), expected.energy.front());
  });
}

// Of this actor's 36 unknowns two are eliminated at a time, in 48 rows: an odd number, and such as need the next 16.
TEST(PoseSteps, AreTheHostsForAnyNumberOfJoints) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    for (int n_more : {-1, 10, 11}) {
      StepsScene scene(device, n_more);
      SCOPED_TRACE(scene.actor.skeleton.n_dofs());
      scene.options.damping_own = 1;  // little tells joints of the same bone apart
      PoseSystem system(device, scene.actor, scene.camera, scene.options);
      scene.give(system);
      const ByTheHost expected = steps_by_the_host(system, scene, 2);
      const std::optional<PoseSteps> got = system.take_steps(scene.start, 2, 0);
      ASSERT_TRUE(got.has_value());
      EXPECT_EQ(got->status, SolveStatus::kOk);
      expect_same(got->state, expected.states[2]);
    }
  });
}

TEST(PoseSteps, RepeatBitForBit) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const StepsScene scene(device);
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    scene.give(system);
    const std::optional<PoseSteps> first = system.take_steps(scene.start, 5, 1);
    ASSERT_TRUE(first.has_value());
    for (int i = 0; i < 3; ++i) {
      const std::optional<PoseSteps> again = system.take_steps(scene.start, 5, 1);
      ASSERT_TRUE(again.has_value());
      EXPECT_EQ(state_values(again->state), state_values(first->state));
      EXPECT_EQ(again->step_energy, first->step_energy);
    }
  });
}

// NaN, and a single point of the picture that six unknowns and more could all explain.
TEST(PoseSteps, TellWhyTheyFail) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    StepsScene scene(device);
    scene.options.damping_own = scene.options.damping_largest = 0;
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    for (const bool defined : {false, true}) {
      scene.give(system);
      KeypointTargets targets;
      targets[kLeftWrist].weight_2d = 1;
      if (defined) system.set_frame(targets, nullptr, {});
      if (defined) system.set_floor(nullptr, {});
      if (!defined) scene.frame.signed_distance.fill(std::numeric_limits<float>::quiet_NaN());
      const std::optional<PoseSteps> got = system.take_steps(scene.start, 5, 0);
      ASSERT_TRUE(got.has_value());
      EXPECT_EQ(got->status, defined ? SolveStatus::kRankDeficient : SolveStatus::kNotFinite);
      EXPECT_EQ(got->status, damped_step(system.assemble(scene.start), scene.options).status);
      EXPECT_EQ(got->step_energy.size(), 1u);
      expect_same(got->state, scene.start);
    }
  });
}

// PoCL has no fence between work-groups: the host takes the steps from then on, and the result is what it would have
// been from the beginning.
TEST(PoseSteps, AreTheHostsWhereGroupsCannotWait) {
  test::on_every_device([](ocl::DeviceContext& device) {
    if (!device.is_cpu()) return;
    ocl::DeviceInfo info = device.info();
    info.is_cpu = false;
    info.compute_units = 3;
    ocl::DeviceContext as_gpu(info);
    const StepsScene scene(as_gpu);
    PoseSystem system(as_gpu, scene.actor, scene.camera, scene.options);
    scene.give(system);
    for (int i = 0; i < 2; ++i) EXPECT_FALSE(system.take_steps(scene.start, 4, 0).has_value());
    PoseSolver solver(as_gpu, scene.actor, scene.camera, scene.options);
    const PoseInput input{.detections = scene.detections,
                          .initial = scene.start.pose,
                          .frame = &scene.frame,
                          .contour_vertices = scene.contour};
    const PoseResult first = solver.solve(input), second = solver.solve(input);
    EXPECT_EQ(first.status, SolveStatus::kOk);
    EXPECT_EQ(first.step_energy.size(), size_t(scene.options.steps));
    EXPECT_EQ(first.step_energy, second.step_energy);
    EXPECT_EQ(first.pose.angles_rad, second.pose.angles_rad);
  });
}

}  // namespace
}  // namespace livecap
