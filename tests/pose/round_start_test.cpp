// What a GPU prepares by itself for a solve that starts where the one before ended (kernels/pose/round_start.h) against
// what the host does: doubt_far_detections, best_t_prime and standing.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "livecap/error.h"
#include "pose/pose_system.h"
#include "support/gpu_bodies.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A pose, detections that lie near or far from it, and where it was a frame ago.
struct RoundScene {
  Actor actor = test::make_test_actor(0.7);
  Camera camera = test::portrait_camera();
  PoseOptions options;
  Pose pose, previous;
  KeypointTargets targets;
  Floor floor;
  double doubt_mm = 60;
  bool has_previous = true;

  explicit RoundScene(unsigned seed) {
    std::mt19937 rng{seed};
    std::uniform_real_distribution<double> uniform(-1, 1);
    options.floor_huber_mm = 0;
    options.rebone = false;
    pose = test::random_true_pose(actor, rng, 0.6);
    previous = test::disturbed(pose, rng, 0.02 * (seed % 3), 10 * (seed % 3));  // every third one holds still
    Detections detections = test::exact_detections(actor, camera, pose, 0.97);
    for (KeypointDetection& keypoint : detections.keypoints) {
      for (float* value : {&keypoint.x_mm, &keypoint.y_mm, &keypoint.z_mm}) *value += float(100 * uniform(rng));
      keypoint.confidence = float(std::max(0.0, 0.5 + uniform(rng)));
    }
    targets = make_targets(actor, detections, &previous, options);
    doubt_mm = std::pow(10, 1.5 + 1.5 * uniform(rng));
    floor.up = Eigen::Vector3d(0.1 * uniform(rng), -1, 0.1 * uniform(rng)).normalized();
    place_floor(25 * (1 + uniform(rng)));
  }

  std::vector<Eigen::Vector3d> soles(const Pose& at) const {
    const PosedSkeleton posed = forward_kinematics(actor.skeleton, at);
    std::vector<Eigen::Vector3d> points;
    for (const SolePoint& sole : sole_points(actor)) points.push_back(posed.camera_from_rest[sole.bone] * sole.rest_mm);
    return points;
  }
  // So far below the lowest point of the soles.
  void place_floor(double below_mm) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& p : soles(pose)) lowest = std::min(lowest, floor.up.dot(p));
    floor.offset_mm = below_mm - lowest;
  }
  std::vector<float> soles_before() const {
    std::vector<float> values;
    if (!has_previous) return values;
    for (const Eigen::Vector3d& p : soles(previous))
      values.insert(values.end(), {float(p.x()), float(p.y()), float(p.z())});
    return values;
  }
};

// Rounds without steps: what the last one prepared. given_stands: of all soles.
PoseSystem::Rounds rounds_of(ocl::DeviceContext& device, const RoundScene& scene, int n_rounds, double given_stands) {
  PoseSystem system(device, scene.actor, scene.camera, scene.options);
  const SeenVertices nothing;
  const std::vector<double> stands(system.soles().size(), given_stands);
  for (int round = 0; round < n_rounds; ++round)
    system.set_round(round, scene.targets, nothing, &scene.floor, stands, scene.soles_before());
  system.begin_rounds(n_rounds, {scene.pose, {7, 8, 9}}, nullptr);
  for (int round = 0; round < n_rounds; ++round)
    system.launch_round({.round = round, .doubt_3d_mm = scene.doubt_mm}, nothing);
  std::optional<PoseSystem::Rounds> done = system.read_rounds();
  EXPECT_TRUE(done.has_value());
  return done.value_or(PoseSystem::Rounds{});
}

void expect_prepared(const PoseSystem::Rounds& got, const RoundScene& scene, const KeypointTargets& targets,
                     const Eigen::Vector3d& t_prime_mm, const std::vector<double>& stands) {
  double total = 0;
  for (const KeypointTarget& target : targets) total += target.weight_3d;
  for (int k = 0; k < kKeypointCount; ++k)
    EXPECT_NEAR(got.weights_3d[k], targets[k].weight_3d, test::kRoundStart * total) << k;
  EXPECT_LT((got.steps.state.t_prime_mm - t_prime_mm).norm(), test::kRoundStartMm);
  const auto points = scene.soles(scene.pose);
  ASSERT_EQ(stands.size(), points.size());
  const int first = LC_POSE_POINT_ROWS + 2 * scene.actor.skeleton.n_dofs();
  for (size_t i = 0; i < points.size(); ++i) {
    const double height = scene.floor.height_mm(points[i]), root = std::sqrt(scene.options.weights.floor);
    EXPECT_NEAR(got.steps.residuals[first + i], root * (height < 0 ? 1 : stands[i]) * height,
                root * test::kRoundStartMm)
        << i;
  }
}

// As the host would have prepared the second round.
void expect_the_hosts(ocl::DeviceContext& device, const RoundScene& scene) {
  constexpr double kGiven = 0.25;
  const auto keypoints = keypoint_positions(scene.actor, forward_kinematics(scene.actor.skeleton, scene.pose));
  KeypointTargets targets = scene.targets;
  if (scene.doubt_mm > 0) doubt_far_detections(targets, keypoints, scene.doubt_mm);
  const std::vector<SolePoint> soles = sole_points(scene.actor);
  const std::vector<double> stands = scene.has_previous ? standing(soles, scene.actor.skeleton, scene.floor, scene.pose,
                                                                   &scene.previous, scene.options.least_stands)
                                                        : std::vector<double>(soles.size(), kGiven);
  expect_prepared(rounds_of(device, scene, 2, kGiven), scene, targets, best_t_prime(targets, keypoints), stands);
}

TEST(RoundStart, IsTheHosts) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    int n_stand = 0, n_hang = 0;
    for (unsigned seed = 0; seed < 24; ++seed) {
      SCOPED_TRACE(seed);
      const RoundScene scene(seed);
      expect_the_hosts(device, scene);
      for (double s :
           standing(sole_points(scene.actor), scene.actor.skeleton, scene.floor, scene.pose, &scene.previous))
        ++(s > 0 ? n_stand : n_hang);
    }
    EXPECT_GT(n_stand, 0);
    EXPECT_GT(n_hang, 0);
  });
}

TEST(RoundStart, IsTheHostsWhereThereIsLittleToTell) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const auto expect_with = [&](const char* what, auto&& change) {
      SCOPED_TRACE(what);
      RoundScene scene(5);
      change(scene);
      expect_the_hosts(device, scene);
    };
    expect_with("no doubt", [](RoundScene& s) { s.doubt_mm = 0; });
    expect_with("legs that are hidden", [](RoundScene& s) { s.options.least_stands = 0.1; });
    expect_with("nothing detected in 3D", [](RoundScene& s) {
      for (KeypointTarget& target : s.targets) target.weight_3d = 0;
    });
    expect_with("one detection", [](RoundScene& s) {
      for (int k = 1; k < kKeypointCount; ++k) s.targets[k].weight_3d = 0;
    });
    expect_with("no frame before", [](RoundScene& s) { s.has_previous = false; });
    expect_with("on the floor", [](RoundScene& s) { s.place_floor(0); });
    expect_with("in the floor", [](RoundScene& s) { s.place_floor(-40); });
    expect_with("far above it", [](RoundScene& s) { s.place_floor(2000); });
    expect_with("no feet", [](RoundScene& s) {
      for (Bone& bone : s.actor.skeleton.bones) bone.name += "_";
    });
  });
}

TEST(RoundStart, SolesOfAnotherCountAreRefused) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const RoundScene scene(1);
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    const std::vector<double> stands(system.soles().size(), 0.0);
    std::vector<float> before = scene.soles_before();
    const auto set = [&] { system.set_round(0, scene.targets, {}, &scene.floor, stands, before); };
    EXPECT_NO_THROW(set());
    before.pop_back();
    EXPECT_THROW(set(), LogicError);
    before.resize(before.size() + 4);
    EXPECT_THROW(set(), LogicError);
    before.clear();
    EXPECT_NO_THROW(set());
  });
}

// Which the host has prepared.
TEST(RoundStart, LeavesTheFirstRoundAsItIs) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const RoundScene scene(3);
    const std::vector<double> given(sole_points(scene.actor).size(), 0.25);
    expect_prepared(rounds_of(device, scene, 1, 0.25), scene, scene.targets, {7, 8, 9}, given);
  });
}

}  // namespace
}  // namespace livecap
