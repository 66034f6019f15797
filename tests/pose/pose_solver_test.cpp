#include "pose/pose_solver.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "livecap/error.h"
#include "solve/term_table.h"
#include "support/kernel_bodies.h"
#include "support/launched_kernels.h"
#include "support/pose_reference.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::disturbed;
using test::exact_detections;
using test::keypoint_distance_mm;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(PoseSolver, RecoversRandomPosesFromTheirDetectionsAlone) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        for (double arms_down : {0.0, 0.7}) {
          const Actor actor = test::make_test_actor(arms_down);
          const Camera camera = test::portrait_camera();
          PoseOptions options;
          options.rebone = false;
          PoseSolver solver(device, actor, camera, options);
          std::mt19937 rng(5);
          for (int trial = 0; trial < 20; ++trial) {
            const Pose truth = test::random_true_pose(actor, rng, 0.5);
            const Detections detections = exact_detections(actor, camera, truth);
            const std::optional<Pose> start = initialize_pose(actor, camera, detections, options);
            ASSERT_TRUE(start.has_value());
            const PoseResult result =
                solver.solve({.detections = detections, .initial = *start, .n_steps = options.first_steps});
            EXPECT_EQ(result.status, SolveStatus::kOk);
            EXPECT_LT(keypoint_distance_mm(actor, result.pose, truth), test::kRecoveredMm) << "trial " << trial;
            EXPECT_LT(result.keypoint_error_px, test::kRecoveredMm);
          }
        }
      },
      test::Doubles::kAlsoWithout);
}

// The network's own scale and lengths: re-boning restores the actor's. Clavicles at rest, whose angles change the
// distance between neck and shoulder.
TEST(PoseSolver, RecoversPosesFromScaledDetections) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor(0.7);
        const Camera camera = test::portrait_camera();
        PoseOptions options;
        options.keypoint_2d_huber_px = options.silhouette_huber_px = 0;  // what it is compared with is quadratic
        PoseSolver solver(device, actor, camera, options);
        std::mt19937 rng(6);
        for (int trial = 0; trial < 10; ++trial) {
          Pose truth = test::random_true_pose(actor, rng, 0.5);
          truth.angles_rad.segment(3, 4).setZero();
          const Detections detections = exact_detections(actor, camera, truth, 0.7);
          const std::optional<Pose> start = initialize_pose(actor, camera, detections, options);
          ASSERT_TRUE(start.has_value());
          const PoseResult result =
              solver.solve({.detections = detections, .initial = *start, .n_steps = options.first_steps});
          EXPECT_LT(keypoint_distance_mm(actor, result.pose, truth), test::kRecoveredMm) << "trial " << trial;
        }
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSolver, SixStepsFollowATrackedFrame) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor(0.7);
        const Camera camera = test::portrait_camera();
        PoseOptions options;
        options.rebone = false;
        options.weights.temporal = 0;
        PoseSolver solver(device, actor, camera, options);
        std::mt19937 rng(7);
        for (int trial = 0; trial < 20; ++trial) {
          const Pose truth = test::random_true_pose(actor, rng, 0.5);
          const Pose previous = disturbed(truth, rng, 0.15, 40);
          const Detections detections = exact_detections(actor, camera, truth);
          const PoseResult result =
              solver.solve({.detections = detections, .initial = previous, .previous = &previous});
          EXPECT_EQ(result.step_energy.size(), 6u);
          EXPECT_LT(keypoint_distance_mm(actor, result.pose, truth), test::kRecoveredMm) << "trial " << trial;
        }
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSolver, KeypointsCountInE3DByTheirFactors) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor actor = test::make_test_actor(0.7);
    const Camera camera = test::portrait_camera();
    PoseSolver solver(device, actor, camera, PoseOptions());
    const Pose pose = test::standing_pose(actor, 0);
    const Detections detections = exact_detections(actor, camera, pose);
    PoseInput input{.detections = detections, .initial = pose};
    const KeypointTargets whole = solver.prepare(input).targets;
    input.share_3d = 0.125;
    input.arms_3d = 0.25;
    input.legs_3d = 0.5;
    const KeypointTargets less = solver.prepare(input).targets;
    for (int k = 0; k < kKeypointCount; ++k) {
      const double factor = k >= kLeftElbow && k <= kRightHand ? 0.25 : k >= kLeftKnee && k <= kRightToe ? 0.5 : 1;
      EXPECT_EQ(less[k].weight_3d, 0.125 * factor * whole[k].weight_3d) << kKeypointNames[k];
      EXPECT_EQ(less[k].weight_2d, whole[k].weight_2d);
    }
  });
}

// All rows of the reference as one Ceres residual block over the increment of `state`.
class ReferenceCost : public ceres::CostFunction {
 public:
  ReferenceCost(const test::PoseReference& reference, const PoseState& state) : reference_(reference), state_(state) {
    set_num_residuals(int(reference.residuals(state).size()));
    mutable_parameter_block_sizes()->push_back(reference.actor.skeleton.n_dofs() + 9);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const int n = parameter_block_sizes()[0];
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(parameters[0], n);
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = at(x);
    if (!jacobians || !jacobians[0]) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(jacobians[0], num_residuals(),
                                                                                         n);
    for (int k = 0; k < n; ++k) {
      const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(n, k);
      J.col(k) = (at(x + step) - at(x - step)) / 2e-6;
    }
    return true;
  }

 private:
  Eigen::VectorXd at(const Eigen::VectorXd& x) const { return reference_.residuals(reference_.moved(state_, x)); }
  const test::PoseReference& reference_;
  const PoseState& state_;
};

TEST(PoseSolver, EnergyIsNotWorseThanCeres) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor(0.7);
        const Camera camera = test::portrait_camera();
        PoseOptions options;
        options.keypoint_2d_huber_px = options.silhouette_huber_px = 0;  // what it is compared with is quadratic
        PoseSolver solver(device, actor, camera, options);
        std::mt19937 rng(8);
        std::normal_distribution<float> noise;
        DeviceFrame frame(device, camera.width, camera.height);
        // Positive everywhere, so that all b_i are 1 and E_silhouette is a plain least-squares term. Weak slope: it
        // competes.
        std::vector<float> distance = test::smooth_distance(camera, 900);
        for (float& value : distance) value *= 0.01f;
        frame.signed_distance.write(distance);
        const std::vector<int32_t> contour = test::some_vertices(actor, 4);
        for (int trial = 0; trial < 6; ++trial) {
          const Pose truth = test::random_true_pose(actor, rng, 0.6);
          const Pose previous = disturbed(truth, rng, 0.08, 20);
          Detections detections = exact_detections(actor, camera, truth, 0.8);
          for (KeypointDetection& d : detections.keypoints) {
            d.x_px += 3 * noise(rng);
            d.y_px += 3 * noise(rng);
            d.x_mm += 20 * noise(rng);
            d.y_mm += 20 * noise(rng);
            d.z_mm += 40 * noise(rng);
            d.confidence = std::uniform_real_distribution<float>(0.3f, 1.0f)(rng);
          }
          const PoseResult result = solver.solve({.detections = detections,
                                                  .initial = previous,
                                                  .previous = &previous,
                                                  .frame = &frame,
                                                  .contour_vertices = contour});
          ASSERT_EQ(result.status, SolveStatus::kOk);
          EXPECT_GT(result.energy.silhouette, 0);

          test::PoseReference reference{actor,   camera,
                                        options, make_targets(actor, detections, &previous, options),
                                        contour, options.weights.silhouette,
                                        distance};
          const PoseState start{previous, result.t_prime_mm};
          std::vector<double> x(actor.skeleton.n_dofs() + 9, 0.0);
          ceres::Problem problem;
          problem.AddResidualBlock(new ReferenceCost(reference, start), nullptr, x.data());
          ceres::Solver::Options ceres_options;
          ceres_options.max_num_iterations = 200;
          ceres_options.linear_solver_type = ceres::DENSE_QR;
          ceres_options.logging_type = ceres::SILENT;
          ceres::Solver::Summary summary;
          ceres::Solve(ceres_options, &problem, &summary);
          const double ceres_energy = 2 * summary.final_cost;
          EXPECT_LE(result.energy.total(), test::kEnergyRatio * ceres_energy) << "trial " << trial;
          // What the result says is what the reference finds there.
          const double reference_energy = reference.residuals({result.pose, result.t_prime_mm}).squaredNorm();
          EXPECT_NEAR(result.energy.total(), reference_energy, test::kPoseJacobian * reference_energy);
        }
      },
      test::Doubles::kAlsoWithout);
}

// Without detections the silhouette alone moves the body, against E_temporal.
TEST(PoseSolver, SilhouettePullsTheBodyToTheContour) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor(0.7);
        const Camera camera = test::portrait_camera();
        PoseOptions quadratic;
        quadratic.keypoint_2d_huber_px = quadratic.silhouette_huber_px =
            0;  // the paper's term, which reaches the contour in six steps
        PoseSolver solver(device, actor, camera, quadratic);
        const Pose start = test::standing_pose(actor, 0);
        // The right border of the silhouette is 12 px left of the rightmost vertices.
        const std::vector<int32_t> all = test::some_vertices(actor, 1);
        test::PoseReference reference{actor, camera, {}, {}, all, 0, {}};
        const PosedSkeleton posed = forward_kinematics(actor.skeleton, start);
        double right = 0;
        std::vector<int32_t> contour;
        for (int i : all) right = std::max(right, reference.project(reference.skin(i, posed).position).x());
        for (int i : all) {
          if (reference.project(reference.skin(i, posed).position).x() > right - 4) contour.push_back(i);
        }
        std::vector<float> distance;
        for (int y = 0; y < camera.height; ++y)
          for (int x = 0; x < camera.width; ++x) distance.push_back(float(x - (right - 12)));
        DeviceFrame frame(device, camera.width, camera.height);
        frame.signed_distance.write(distance);
        const Detections nobody;
        const PoseResult result = solver.solve(
            {.detections = nobody, .initial = start, .previous = &start, .frame = &frame, .contour_vertices = contour});
        EXPECT_EQ(result.status, SolveStatus::kOk);
        // E_temporal pulls back; what is left is a small share of the 12 px.
        const PosedSkeleton solved = forward_kinematics(actor.skeleton, result.pose);
        double error_px = 0;
        for (int i : contour)
          error_px += std::abs(reference.project(reference.skin(i, solved).position).x() - (right - 12));
        EXPECT_LT(error_px / double(contour.size()), 2);
        EXPECT_GT(result.step_energy.front(), 10 * result.energy.total());
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSolver, EndsWhenAStepMovesLittleInThePicture) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor(0.7);
        const Camera camera = test::portrait_camera();
        PoseOptions options;
        options.rebone = false;
        PoseSolver solver(device, actor, camera, options);
        std::mt19937 rng(12);
        const Pose truth = test::random_true_pose(actor, rng, 0.5);
        const Detections detections = exact_detections(actor, camera, truth);
        const Pose start = disturbed(truth, rng, 0.1, 30);
        const auto solve = [&](int n_steps, double settled_px) {
          return solver.solve(
              {.detections = detections, .initial = start, .n_steps = n_steps, .settled_px = settled_px});
        };
        // Furthest way of a keypoint from one pose to the other.
        const auto distance_px = [&](const Pose& a, const Pose& b) {
          const Detections from = exact_detections(actor, camera, a), to = exact_detections(actor, camera, b);
          double most = 0;
          for (int k = 0; k < kKeypointCount; ++k)
            most = std::max(most, std::hypot(double(to.keypoints[k].x_px) - from.keypoints[k].x_px,
                                             double(to.keypoints[k].y_px) - from.keypoints[k].y_px));
          return most;
        };
        constexpr int kSteps = 8;
        std::vector<Pose> poses = {start};  // after each step
        for (int n = 1; n <= kSteps; ++n) poses.push_back(solve(n, 0).pose);
        for (double settled_px : {3.0, 0.1}) {
          size_t expected = 1;
          while (distance_px(poses[expected - 1], poses[expected]) >= settled_px) ++expected;
          ASSERT_GT(expected, 1u);
          ASSERT_LT(expected, size_t(kSteps));
          const PoseResult result = solve(kSteps, settled_px);
          EXPECT_EQ(result.step_energy.size(), expected);
          EXPECT_LT(keypoint_distance_mm(actor, result.pose, poses[expected]), 1e-9);
          EXPECT_NEAR(result.moved_px, distance_px(start, result.pose), 1e-3);
        }
        EXPECT_EQ(solve(kSteps, 1e9).step_energy.size(), 1u);
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSolver, RepeatsBitForBit) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor(0.7);
        const Camera camera = test::portrait_camera();
        std::mt19937 rng(9);
        const Pose truth = test::random_true_pose(actor, rng, 0.6);
        const Pose previous = disturbed(truth, rng, 0.1, 20);
        const Detections detections = exact_detections(actor, camera, truth, 0.9);
        DeviceFrame frame(device, camera.width, camera.height);
        frame.signed_distance.write(test::smooth_distance(camera));
        const std::vector<int32_t> contour = test::some_vertices(actor, 2);
        std::optional<PoseResult> first;
        for (int i = 0; i < 3; ++i) {
          PoseSolver solver(device, actor, camera, {});
          const PoseResult result = solver.solve({.detections = detections,
                                                  .initial = previous,
                                                  .previous = &previous,
                                                  .frame = &frame,
                                                  .contour_vertices = contour});
          if (!first) first = result;
          EXPECT_EQ(result.pose.angles_rad, first->pose.angles_rad);
          EXPECT_EQ(result.pose.root_rotation, first->pose.root_rotation);
          EXPECT_EQ(result.pose.root_translation_mm, first->pose.root_translation_mm);
          EXPECT_EQ(result.step_energy, first->step_energy);
        }
        EXPECT_GT(keypoint_distance_mm(actor, first->pose, previous), 1);
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSolver, NothingToSeeReturnsThePrediction) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor();
        const Camera camera = test::portrait_camera();
        PoseSolver solver(device, actor, camera, {});
        const Pose start = test::standing_pose(actor, 0.3);
        Detections unsure = exact_detections(actor, camera, start);
        for (KeypointDetection& d : unsure.keypoints) d.confidence = 0;
        Detections nobody = exact_detections(actor, camera, start);
        nobody.person = false;
        Detections undefined = exact_detections(actor, camera, start);
        for (KeypointDetection& d : undefined.keypoints) d = {NAN, NAN, NAN, NAN, NAN, NAN};
        for (const Detections& detections : {Detections{}, unsure, nobody, undefined}) {
          const PoseResult result = solver.solve({.detections = detections, .initial = start, .previous = &start});
          EXPECT_EQ(result.status, SolveStatus::kNoObservations);
          EXPECT_EQ(keypoint_distance_mm(actor, result.pose, start), 0);
        }
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSolver, AnEmptyContourOrOneKeypointIsEnough) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor();
        const Camera camera = test::portrait_camera();
        PoseSolver solver(device, actor, camera, {});
        DeviceFrame frame(device, camera.width, camera.height);
        frame.signed_distance.fill(5.0f);
        const Pose start = test::standing_pose(actor, 0.3);
        Detections one = exact_detections(actor, camera, start);
        for (KeypointDetection& d : one.keypoints) d.confidence = 0;
        one.keypoints[kLeftWrist].confidence = 1;
        one.keypoints[kLeftWrist].x_px += 20;
        const PoseResult result = solver.solve({.detections = one, .initial = start, .frame = &frame});
        EXPECT_EQ(result.status, SolveStatus::kOk);
        EXPECT_LT(result.keypoint_error_px, 1.0);
        EXPECT_EQ(result.energy.silhouette, 0);
        // Far from the camera's view: no vertex counts, nothing breaks.
        Pose behind = start;
        behind.root_translation_mm.z() = -3000;
        const std::vector<int32_t> contour = test::some_vertices(actor, 5);
        const PoseResult lost = solver.solve(
            {.detections = one, .initial = behind, .frame = &frame, .contour_vertices = contour, .n_steps = 1});
        EXPECT_EQ(lost.energy.silhouette, 0);
        EXPECT_TRUE(lost.pose.angles_rad.allFinite());
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSolver, NanGivesThePredictionAndAStatus) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor();
        const Camera camera = test::portrait_camera();
        PoseSolver solver(device, actor, camera, {});
        const Pose start = test::standing_pose(actor, 0.3);
        const Detections detections = exact_detections(actor, camera, start);
        const std::vector<int32_t> contour = test::some_vertices(actor, 5);
        DeviceFrame frame(device, camera.width, camera.height);
        frame.signed_distance.fill(std::numeric_limits<float>::quiet_NaN());
        const PoseResult result =
            solver.solve({.detections = detections, .initial = start, .frame = &frame, .contour_vertices = contour});
        EXPECT_EQ(result.status, SolveStatus::kNotFinite);
        EXPECT_EQ(keypoint_distance_mm(actor, result.pose, start), 0);

        Pose bad_previous = start;
        bad_previous.angles_rad[4] = kNan;
        const PoseResult with_bad_previous =
            solver.solve({.detections = detections, .initial = start, .previous = &bad_previous});
        EXPECT_EQ(with_bad_previous.status, SolveStatus::kNotFinite);
        Detections partly = detections;
        partly.keypoints[kNose].x_px = NAN;
        EXPECT_EQ(solver.solve({.detections = partly, .initial = start}).status, SolveStatus::kOk);
      },
      test::Doubles::kAlsoWithout);
}

// A knee whose depth the network has wrong by 300 mm: doubted, it takes the body less than half as far along.
TEST(PoseSolver, ADoubtedDetectionHasLessOfASay) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor actor = test::make_test_actor(0.7);
    const Camera camera = test::portrait_camera();
    std::mt19937 rng(11);
    const Pose truth = test::random_true_pose(actor, rng, 0.3);
    Detections detections = test::exact_detections(actor, camera, truth, 0.9);
    detections.keypoints[kLeftKnee].z_mm += 300;
    PoseOptions options;
    options.rebone = false;
    PoseSolver solver(device, actor, camera, options);
    const auto expected = keypoint_positions(actor, forward_kinematics(actor.skeleton, truth));
    const auto error_mm = [&](double doubt_3d_mm) {
      const PoseResult result =
          solver.solve({.detections = detections, .initial = truth, .doubt_3d_mm = doubt_3d_mm, .n_steps = 20});
      EXPECT_EQ(result.status, SolveStatus::kOk);
      const auto found = keypoint_positions(actor, forward_kinematics(actor.skeleton, result.pose));
      return (found[kLeftKnee] - expected[kLeftKnee]).norm();
    };
    EXPECT_LT(error_mm(60), 0.5 * error_mm(0));
  });
}

TEST(PoseSolver, DefaultWeightsAreTheTermTables) {
  const PoseWeights weights;
  EXPECT_EQ(weights.keypoint_2d, find_term("keypoint_2d")->paper_weight);
  EXPECT_EQ(weights.keypoint_3d, find_term("keypoint_3d")->paper_weight);
  EXPECT_EQ(weights.silhouette, 6.5 * find_term("pose_silhouette")->paper_weight);  // see docs/experiments.md
  EXPECT_EQ(weights.temporal, find_term("temporal")->paper_weight);
  EXPECT_EQ(weights.anatomic, 10 * find_term("anatomic")->paper_weight);
}

// --without TERM: weight 0 by name removes exactly that energy.
TEST(PoseSolver, EveryTermCanBeSwitchedOffByName) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const Actor actor = test::make_test_actor(0.7);
        const Camera camera = test::portrait_camera();
        std::mt19937 rng(10);
        const Pose truth = test::random_true_pose(actor, rng, 0.6);
        Pose start = disturbed(truth, rng, 0.1, 20);
        const Detections detections = exact_detections(actor, camera, truth, 0.9);
        DeviceFrame frame(device, camera.width, camera.height);
        frame.signed_distance.write(test::smooth_distance(camera));
        const std::vector<int32_t> contour = test::some_vertices(actor, 2);
        const std::vector<VertexMatch> matches = {{.vertex = 3, .u_px = 10, .v_px = 20}};
        const std::vector<ShadedVertex> shaded = {{.vertex = 5, .light = {1, 0.5f}, .brightness = 3}};
        const Floor floor{-Eigen::Vector3d::UnitY(), -5000};  // high above
        for (const Term& term : term_table()) {
          PoseOptions options;
          // Limits that no pose keeps, so that E_anatomic is never zero by itself.
          Actor cramped = actor;
          cramped.skeleton.dofs[0].min_rad = cramped.skeleton.dofs[0].max_rad = 3;
          cramped.skeleton.dofs[1].rest_share = 0.01;
          EXPECT_EQ(set_weight(options.weights, term.name, 0), term.stage == TermStage::kPose) << term.name;
          PoseSolver solver(device, cramped, camera, options);
          const PoseEnergies e = solver
                                     .solve({.detections = detections,
                                             .initial = start,
                                             .previous = &start,
                                             .frame = &frame,
                                             .contour_vertices = contour,
                                             .matches = matches,
                                             .shaded = shaded,
                                             .floor = &floor,
                                             .n_steps = 1})
                                     .energy;
          EXPECT_EQ(e.keypoint_2d == 0, term.name == "keypoint_2d") << term.name;
          EXPECT_EQ(e.keypoint_3d == 0, term.name == "keypoint_3d") << term.name;
          EXPECT_EQ(e.silhouette == 0, term.name == "pose_silhouette") << term.name;
          EXPECT_EQ(e.match == 0, term.name == "match") << term.name;
          EXPECT_EQ(e.shading == 0, term.name == "shading") << term.name;
          EXPECT_EQ(e.floor == 0, term.name == "floor") << term.name;
          EXPECT_EQ(e.temporal == 0, term.name == "temporal") << term.name;
          EXPECT_EQ(e.anatomic == 0, term.name == "anatomic") << term.name;
          EXPECT_EQ(e.rest == 0, term.name == "rest") << term.name;
        }
      },
      test::Doubles::kAlsoWithout);
}

// What a keypoint far from where it was costs where arms compete: r^2 / (1 + r^2 / s^2), which ends at s^2.
TEST(PoseSolver, DoubtedTemporalEnergyEndsAtItsScale) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor actor = test::make_test_actor(0.7);
    const Camera camera = test::portrait_camera();
    std::mt19937 rng(11);
    const Pose truth = test::random_true_pose(actor, rng, 0.6);
    const Detections detections = exact_detections(actor, camera, truth, 0.9);
    Pose previous = truth;
    previous.root_translation_mm.x() += 700;
    for (const double scale_mm : {0.0, 150.0, 1e6}) {
      PoseOptions options;
      options.temporal_doubt_mm = scale_mm;
      PoseSolver solver(device, actor, camera, options);
      const PoseResult result =
          solver.solve({.detections = detections, .initial = truth, .previous = &previous, .n_steps = 1});
      ASSERT_EQ(result.status, SolveStatus::kOk);
      const auto now = keypoint_positions(actor, forward_kinematics(actor.skeleton, result.pose));
      const auto before = keypoint_positions(actor, forward_kinematics(actor.skeleton, previous));
      double whole = 0, doubted = 0;
      for (int k = 0; k < kKeypointCount; ++k) {
        if (actor.keypoints[k].bone < 0) continue;
        const double weight = options.weights.temporal * options.temporal_weights[k];
        const double r = (now[k] - before[k]).norm();
        whole += weight * r * r;
        doubted += weight * (scale_mm > 0 ? 1 / (1 / (r * r) + 1 / (scale_mm * scale_mm)) : r * r);
      }
      EXPECT_NEAR(result.energy.temporal, whole, test::kFloatRelative * whole);
      EXPECT_NEAR(result.energy.doubted_temporal, doubted, test::kFloatRelative * doubted) << scale_mm;
    }
  });
}

TEST(PoseSolver, SelfTestPassesOnEveryDevice) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        const auto results = pose_self_test(device);
        const bool takes_steps = !device.is_cpu() && device.info().has_double;
        const bool chooses = PoseSolver(device, test::make_test_actor(0.7), test::portrait_camera(), {}).chooses();
        EXPECT_EQ(results.size(), 7u + takes_steps + chooses);
        for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
        std::vector<const char*> programs = {"pose/pose.cl", "pose/slices.cl"};
        if (!device.is_cpu()) programs = {"pose/gauss_newton.cl"};
        if (chooses) programs.push_back("pose/choose.cl");
        for (const char* program : programs) test::expect_every_kernel_launched(device.info(), program, pose_self_test);
      },
      test::Doubles::kAlsoWithout);
}

}  // namespace
}  // namespace livecap
