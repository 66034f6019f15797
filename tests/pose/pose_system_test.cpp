#include "pose/pose_system.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "actor/skinner.h"
#include "livecap/error.h"
#include "pose/pose_solver.h"
#include "support/kernel_bodies.h"
#include "support/pose_reference.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A scene in which every term has non-zero residuals: a disturbed pose, a previous frame, broken joint limits.
struct SystemScene {
  Actor actor = test::make_test_actor(0.6);
  Camera camera = test::portrait_camera();
  PoseOptions options;
  std::mt19937 rng{17};
  Pose truth = test::random_true_pose(actor, rng, 0.6);
  Pose previous = test::disturbed(truth, rng, 0.1, 30);
  Detections detections = test::exact_detections(actor, camera, truth, 0.8);
  PoseState state{test::disturbed(truth, rng, 0.2, 60), {20, -40, 3100}};
  std::vector<int32_t> contour = test::some_vertices(actor, 2);
  std::vector<float> distance = test::smooth_distance(camera);
  // Through the middle of the feet, askew: some points are above it, some below.
  Floor floor{Eigen::Vector3d(0.1, -0.98, -0.05).normalized()};
  std::vector<double> stands;

  SystemScene() {
    options.keypoint_2d_huber_px = options.silhouette_huber_px = options.floor_huber_mm =
        0;                                                     // the reference is quadratic
    state.pose.angles_rad[actor.skeleton.n_dofs() - 1] = 1.5;  // beyond its limit
    state.pose.angles_rad[10] = -3.0;
    actor.skeleton.dofs[3].rest_share = 0.4;
    actor.skeleton.dofs[3].rest_rad = 0.3;
    const std::vector<SolePoint> soles = sole_points(actor);
    const PosedSkeleton posed = forward_kinematics(actor.skeleton, state.pose);
    for (const SolePoint& sole : soles) {
      floor.offset_mm -= floor.up.dot(posed.camera_from_rest[sole.bone] * sole.rest_mm) / double(soles.size());
      stands.push_back(0.1 * double(stands.size() % 10));
    }
    for (int k = 0; k < kKeypointCount; ++k) detections.keypoints[k].confidence = 0.3f + 0.03f * k;
  }

  test::PoseReference reference(double contour_root) const {
    return {actor,
            camera,
            options,
            make_targets(actor, detections, &previous, options),
            contour,
            contour_root * contour_root,
            distance,
            floor,
            sole_points(actor),
            stands};
  }
};

// Runs check(system, reference, scene) on every device.
template <typename Check>
void with_system(Check&& check) {
  test::on_every_device_and_body(
      [&](ocl::DeviceContext& device) {
        SystemScene scene;
        PoseSystem system(device, scene.actor, scene.camera, scene.options);
        DeviceFrame frame(device, scene.camera.width, scene.camera.height);
        frame.signed_distance.write(scene.distance);
        system.set_frame(make_targets(scene.actor, scene.detections, &scene.previous, scene.options), &frame,
                         scene.contour);
        system.set_floor(&scene.floor, scene.stands);
        ASSERT_EQ(system.n_contour(), int(scene.contour.size()));
        ASSERT_FALSE(system.soles().empty());
        check(system, scene.reference(system.contour_root()), scene);
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSystem, ResidualsAreTheReferences) {
  with_system([](PoseSystem& system, const test::PoseReference& reference, const SystemScene& scene) {
    const Eigen::VectorXd expected = reference.residuals(scene.state);
    const std::vector<float> got = system.residuals(scene.state);
    ASSERT_EQ(Eigen::Index(got.size()), expected.size());
    for (Eigen::Index i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(got[i], expected[i], test::kFloatRelative * expected.lpNorm<Eigen::Infinity>()) << "row " << i;
    const PosedSkeleton posed = forward_kinematics(scene.actor.skeleton, scene.state.pose);
    int n_outside = 0;
    for (int i = 0; i < system.n_contour(); ++i) {
      const bool inside = reference.in_picture(reference.skin(scene.contour[i], posed).position);
      n_outside += !inside;
      if (!inside) EXPECT_EQ(got[system.n_point_rows() + i], 0) << "contour vertex " << i;
    }
    EXPECT_LT(n_outside, system.n_contour());
  });
}

TEST(PoseSystem, JacobianIsTheDerivativeOfTheReference) {
  with_system([](PoseSystem& system, const test::PoseReference& reference, const SystemScene& scene) {
    const Eigen::MatrixXd expected = reference.jacobian(scene.state);
    const Eigen::MatrixXd got = system.jacobian(scene.state).cast<double>();
    ASSERT_EQ(got.rows(), expected.rows());
    ASSERT_EQ(got.cols(), expected.cols());
    const PosedSkeleton posed = forward_kinematics(scene.actor.skeleton, scene.state.pose);
    int n_against = 0;
    for (Eigen::Index row = 0; row < got.rows(); ++row) {
      double b = 1;
      if (row >= system.n_point_rows()) {
        double margin = 0;
        b = reference.direction(scene.contour[row - system.n_point_rows()], posed, margin);
        if (margin < test::kTermResidual) continue;  // either sign is right
        n_against += b < 0;
      }
      EXPECT_LT((got.row(row) - b * expected.row(row)).lpNorm<Eigen::Infinity>(),
                test::kPoseJacobian * std::max(1.0, expected.row(row).lpNorm<Eigen::Infinity>()))
          << "row " << row;
    }
    EXPECT_GT(n_against, 5) << "no vertex took case 2 of the paper's figure";
    // Every unknown is in some residual, so the comparison above was not void.
    for (Eigen::Index k = 0; k < expected.cols(); ++k) EXPECT_GT(expected.col(k).norm(), 1) << "column " << k;
  });
}

TEST(PoseSystem, NormalEquationsAreEigensProductOfTheRows) {
  with_system([](PoseSystem& system, const test::PoseReference&, const SystemScene& scene) {
    const Eigen::MatrixXd J = system.jacobian(scene.state).cast<double>();
    const std::vector<float> rows = system.residuals(scene.state);
    const Eigen::VectorXd F = Eigen::Map<const Eigen::VectorXf>(rows.data(), rows.size()).cast<double>();
    const PoseNormalEquations got = system.assemble(scene.state);
    const Eigen::MatrixXd A = J.transpose() * J;
    const Eigen::VectorXd g = J.transpose() * F;
    const double energy = F.squaredNorm();
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      for (Eigen::Index j = 0; j < A.cols(); ++j)
        EXPECT_NEAR(got.JtJ(i, j), A(i, j), test::kGramFloat * std::sqrt(A(i, i) * A(j, j)));
      EXPECT_NEAR(got.JtF[i], g[i], test::kGramFloat * std::sqrt(A(i, i) * energy));
    }
    EXPECT_NEAR(got.energy, energy, test::kGramFloat * energy);
    EXPECT_EQ(got.JtJ, got.JtJ.transpose());
  });
}

// Other weights than the actor's are as an actor with these.
TEST(PoseSystem, OtherWeightsMoveTheContour) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const SystemScene scene;
    SkinWeights other = scene.actor.skin;
    for (size_t k = 0; k < other.bones.size(); ++k) {
      other.bones[k] = 0;
      other.weights[k] = k % kMaxInfluences == 0 ? 1.0f : 0.0f;
    }
    Actor changed = scene.actor;
    changed.skin = other;
    DeviceFrame frame(device, scene.camera.width, scene.camera.height);
    frame.signed_distance.write(scene.distance);
    const auto equations = [&](PoseSystem system) {
      system.set_frame(make_targets(scene.actor, scene.detections, &scene.previous, scene.options), &frame,
                       scene.contour);
      return system.assemble(scene.state);
    };
    const PoseNormalEquations given = equations({device, scene.actor, other, scene.camera, scene.options});
    EXPECT_EQ(given.JtJ, equations({device, changed, scene.camera, scene.options}).JtJ);
    EXPECT_NE(given.JtJ, equations({device, scene.actor, scene.camera, scene.options}).JtJ);
    other.bones[0] = scene.actor.skeleton.n_bones();
    EXPECT_THROW(PoseSystem(device, scene.actor, other, scene.camera, scene.options), LogicError);
  });
}

TEST(PoseSystem, RepeatsBitForBit) {
  with_system([](PoseSystem& system, const test::PoseReference&, const SystemScene& scene) {
    const PoseNormalEquations first = system.assemble(scene.state);
    for (int i = 0; i < 3; ++i) {
      const PoseNormalEquations again = system.assemble(scene.state);
      EXPECT_EQ(again.JtJ, first.JtJ);
      EXPECT_EQ(again.JtF, first.JtF);
    }
  });
}

TEST(PoseSystem, ContourCountsAroundTheVectorWidth) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        SystemScene scene;
        PoseSystem system(device, scene.actor, scene.camera, scene.options);
        DeviceFrame frame(device, scene.camera.width, scene.camera.height);
        frame.signed_distance.write(scene.distance);
        const KeypointTargets targets = make_targets(scene.actor, scene.detections, &scene.previous, scene.options);
        const std::vector<int32_t> all = scene.contour;
        for (int n : {0, 1, 63, 64, 65}) {
          scene.contour.assign(all.begin(), all.begin() + n);
          system.set_frame(targets, &frame, scene.contour);
          system.set_floor(&scene.floor, scene.stands);
          const Eigen::VectorXd expected = scene.reference(system.contour_root()).residuals(scene.state);
          const double energy = expected.squaredNorm();
          EXPECT_NEAR(system.assemble(scene.state).energy, energy, test::kPoseJacobian * energy) << n;
        }
      },
      test::Doubles::kAlsoWithout);
}

// Behind contour and matches, in counts around the vector width: L = 0.5 + n_x + 2 n_y, exact by hand.
TEST(PoseSystem, ShadedVerticesFollowTheirNormals) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        SystemScene scene;
        scene.options.shading_huber = scene.options.match_huber_px = 0;
        PoseSystem system(device, scene.actor, scene.camera, scene.options);
        DeviceFrame frame(device, scene.camera.width, scene.camera.height);
        frame.signed_distance.write(scene.distance);
        const std::vector<float> normals = vertex_normals(scene.actor.mesh.positions, scene.actor.mesh.triangles);
        const test::PoseReference reference = scene.reference(1);
        const auto residual = [&](const ShadedVertex& s, const PoseState& state) {
          const auto skinned = reference.skin(s.vertex, forward_kinematics(scene.actor.skeleton, state.pose));
          const Eigen::Vector3d n =
              skinned.rotation * Eigen::Map<const Eigen::Vector3f>(&normals[3 * s.vertex]).cast<double>();
          return std::sqrt(scene.options.weights.shading * s.weight) * (0.5 + n.x() + 2 * n.y() - s.brightness);
        };
        const std::vector<VertexMatch> matches(37, {.vertex = 3, .u_px = 200, .v_px = 300});
        for (int n : {0, 1, 63, 64, 65}) {
          std::vector<ShadedVertex> shaded;
          for (int i = 0; i < n; ++i)
            shaded.push_back(
                {(7 * i) % scene.actor.n_vertices(), {0.5f, 1, 2}, 0.1f * float(i % 5), 0.5f + float(i % 3)});
          system.set_frame(make_targets(scene.actor, scene.detections, &scene.previous, scene.options), &frame,
                           scene.contour, matches, shaded);
          ASSERT_EQ(system.n_shaded(), n);
          const std::vector<float> rows = system.residuals(scene.state);
          const Eigen::MatrixXd J = system.jacobian(scene.state).cast<double>();
          const int first = system.n_rows() - n;
          const double scale = std::sqrt(scene.options.weights.shading);
          for (int i = 0; i < n; ++i) {
            EXPECT_NEAR(rows[first + i], residual(shaded[i], scene.state), test::kPoseJacobian * scale)
                << n << " " << i;
            for (int k = 0; k < system.n_unknowns() - 3; ++k) {
              const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(system.n_unknowns() - 3, k);
              const double numeric =
                  (residual(shaded[i], {add_increment(scene.state.pose, step), scene.state.t_prime_mm}) -
                   residual(shaded[i], {add_increment(scene.state.pose, -step), scene.state.t_prime_mm})) /
                  2e-5;
              EXPECT_NEAR(J(first + i, k), numeric, 10 * test::kPoseJacobian * scale) << n << " " << i << " " << k;
            }
          }
          const Eigen::VectorXd F = Eigen::Map<const Eigen::VectorXf>(rows.data(), rows.size()).cast<double>();
          const PoseNormalEquations got = system.assemble(scene.state);
          EXPECT_NEAR(got.energy, F.squaredNorm(), test::kGramFloat * F.squaredNorm()) << n;
          const Eigen::VectorXd diagonal = J.colwise().squaredNorm();
          for (int k = 0; k < system.n_unknowns(); ++k)
            EXPECT_NEAR(got.JtJ(k, k), diagonal[k], test::kGramFloat * diagonal[k]) << n << " " << k;
        }
        EXPECT_THROW(
            system.set_frame({}, nullptr, {}, {}, std::vector<ShadedVertex>{{.vertex = scene.actor.n_vertices()}}),
            LogicError);
      },
      test::Doubles::kAlsoWithout);
}

TEST(PoseSystem, ThinnedContourKeepsItsWeight) {
  test::on_every_device([](ocl::DeviceContext& device) {
    SystemScene scene;
    scene.options.max_contour_vertices = 50;
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    DeviceFrame frame(device, scene.camera.width, scene.camera.height);
    frame.signed_distance.fill(3.0f);
    system.set_frame(KeypointTargets{}, &frame, scene.contour);
    EXPECT_EQ(system.n_contour(), 50);
    const PoseState standing{test::standing_pose(scene.actor, 0), {}};
    const PoseNormalEquations equations = system.assemble(standing);
    EXPECT_NEAR(equations.energy, scene.options.weights.silhouette * scene.contour.size() * 9,
                test::kPoseJacobian * equations.energy);
  });
}

TEST(PoseSystem, RobustSilhouetteGrowsLinearlyBeyondItsThreshold) {
  test::on_every_device([](ocl::DeviceContext& device) {
    SystemScene scene;
    scene.options.silhouette_huber_px = 3;
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    DeviceFrame frame(device, scene.camera.width, scene.camera.height);
    const PoseState standing{test::standing_pose(scene.actor, 0), {}};
    for (const float distance_px : {2.0f, 12.0f}) {
      frame.signed_distance.fill(distance_px);
      system.set_frame(KeypointTargets{}, &frame, scene.contour);
      const PoseNormalEquations equations = system.assemble(standing);
      const double each = distance_px < 3 ? distance_px * distance_px : 3.0 * distance_px;
      EXPECT_NEAR(equations.energy, scene.options.weights.silhouette * scene.contour.size() * each,
                  test::kPoseJacobian * equations.energy);
    }
  });
}

TEST(PoseSystem, RobustKeypointsGrowLinearlyBeyondTheirThreshold) {
  test::on_every_device([](ocl::DeviceContext& device) {
    SystemScene scene;
    scene.options.keypoint_2d_huber_px = 8;
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    const PoseState standing{test::standing_pose(scene.actor, 0), {}};
    const Detections seen = test::exact_detections(scene.actor, scene.camera, standing.pose);
    for (const double distance_px : {5.0, 40.0}) {
      KeypointTargets targets;
      for (int k = 0; k < kKeypointCount; ++k) {
        targets[k].weight_2d = 2;
        targets[k].position_px = {seen.keypoints[k].x_px + 0.6 * distance_px,
                                  seen.keypoints[k].y_px - 0.8 * distance_px};
      }
      system.set_frame(targets, nullptr, {});
      const double each = distance_px < 8 ? distance_px * distance_px : 8 * distance_px;
      const double energy = system.assemble(standing).energy;
      EXPECT_NEAR(energy, 2 * kKeypointCount * each, test::kPoseJacobian * energy) << distance_px;
    }
  });
}

TEST(PoseSystem, WrongInputsAreRefused) {
  test::on_every_device([](ocl::DeviceContext& device) {
    SystemScene scene;
    PoseSystem system(device, scene.actor, scene.camera, scene.options);
    DeviceFrame frame(device, scene.camera.width, scene.camera.height);
    DeviceFrame small(device, 100, 100);
    const std::vector<int32_t> beyond = {0, scene.actor.n_vertices()};
    EXPECT_THROW(system.set_frame({}, nullptr, {}, std::vector<VertexMatch>{{.vertex = scene.actor.n_vertices()}}),
                 LogicError);
    EXPECT_THROW(system.set_frame({}, &frame, beyond), LogicError);
    EXPECT_THROW(system.set_frame({}, &small, scene.contour), LogicError);
    Actor broken = scene.actor;
    broken.skin.bones[7] = 99;
    EXPECT_THROW(PoseSystem(device, broken, scene.camera, scene.options), LogicError);
    PoseOptions negative;
    negative.weights.temporal = -1;
    EXPECT_THROW(PoseSystem(device, scene.actor, scene.camera, negative), ConfigError);
    PoseOptions undefined;
    undefined.keypoint_3d_weights[kLeftKnee] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(PoseSystem(device, scene.actor, scene.camera, undefined), ConfigError);
  });
}

TEST(PoseSystem, SharesAreFromNoneToAll) {
  for (double PoseOptions::*share : {&PoseOptions::least_stands, &PoseOptions::hidden_confidence}) {
    PoseOptions options;
    for (const double right : {0.0, 1.0}) {
      options.*share = right;
      EXPECT_NO_THROW(options.validate());
    }
    for (const double wrong : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()}) {
      options.*share = wrong;
      EXPECT_THROW(options.validate(), ConfigError);
    }
  }
}

// Matches of all vertices, so far from where they are in the scene's pose.
std::vector<VertexMatch> matched_beside(ocl::DeviceContext& device, const SystemScene& scene, Eigen::Vector2d by_px) {
  Skinner skinner(device, scene.actor);
  skinner.set_pose(bone_dual_quats(forward_kinematics(scene.actor.skeleton, scene.state.pose)));
  ocl::Buffer<float> zero(device, 3 * size_t(scene.actor.n_vertices())), positions(device, zero.size());
  zero.fill(0);
  skinner.skin(zero, positions);
  const std::vector<float> p = positions.read_all();
  std::vector<VertexMatch> matches;
  for (int i = 0; i < scene.actor.n_vertices(); ++i) {
    const Eigen::Vector2d px = project_px(scene.camera, {p[3 * i], p[3 * i + 1], p[3 * i + 2]}) + by_px;
    matches.push_back({.vertex = i, .u_px = float(px.x()), .v_px = float(px.y())});
  }
  return matches;
}

// By how far it is in the picture, and not by how much of that counts: patches slide along edges.
TEST(PoseSystem, RobustMatchesGrowLinearlyBeyondTheirThreshold) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        SystemScene scene;
        scene.options.match_huber_px = 2;
        scene.options.max_matches = scene.actor.n_vertices();
        PoseSystem system(device, scene.actor, scene.camera, scene.options);
        for (const auto& [distance_px, match_px] : {std::pair(1.5, 1.0), {6.0, 1.0}, {3.5, 2.0}, {6.0, 2.0}}) {
          system.set_match_px(match_px);
          std::vector<VertexMatch> matches = matched_beside(device, scene, {0.6 * distance_px, 0.8 * distance_px});
          for (VertexMatch& match : matches) match.a = 0.5f;
          system.set_frame({}, nullptr, {}, matches);
          ASSERT_EQ(system.n_matches(), scene.actor.n_vertices());
          const std::vector<float> rows = system.residuals(scene.state);
          double energy = 0;
          for (size_t i = system.n_point_rows(); i < rows.size(); ++i) energy += double(rows[i]) * rows[i];
          const double counted = 0.25 * 0.36 + 0.64;  // of the distance's square
          const double each = counted * distance_px * std::min(distance_px, 2 * match_px);
          const double expected = scene.options.weights.match * matches.size() * each;
          EXPECT_NEAR(energy, expected, test::kMatchedBeside * expected) << distance_px << " " << match_px;
        }
      },
      test::Doubles::kAlsoWithout);
}

// Half of the matches on either side hold the pose; each costs in proportion to the threshold, in px of its level.
TEST(PoseSystem, MatchesOfCoarseLevelsAreRobustFurtherOut) {
  test::on_every_device([](ocl::DeviceContext& device) {
    SystemScene scene;
    scene.options.match_huber_px = 1;
    std::vector<VertexMatch> matches = matched_beside(device, scene, {-8, 0});
    const std::vector<VertexMatch> others = matched_beside(device, scene, {8, 0});
    matches.insert(matches.end(), others.begin(), others.end());
    scene.options.max_matches = int(matches.size());
    PoseSolver solver(device, scene.actor, scene.camera, scene.options);
    const Detections seen = test::exact_detections(scene.actor, scene.camera, scene.state.pose);
    for (const double match_px : {1.0, 4.0, 2.0}) {
      const PoseResult result = solver.solve({.detections = seen,
                                              .initial = scene.state.pose,
                                              .previous = &scene.state.pose,
                                              .matches = matches,
                                              .match_px = match_px,
                                              .n_steps = 1});
      const double expected = scene.options.weights.match * double(matches.size()) * 8 * match_px;
      EXPECT_NEAR(result.energy.match, expected, 0.02 * expected) << match_px;
    }
  });
}

// More matches than rows: the heavy ones stay, and the total weight with them.
TEST(PoseSystem, MatchesAreThinnedToTheirTotalWeight) {
  test::on_every_device_and_body(
      [](ocl::DeviceContext& device) {
        SystemScene scene;
        scene.options.max_matches = 40;
        scene.options.match_huber_px = 0;
        PoseSystem system(device, scene.actor, scene.camera, scene.options);
        std::vector<VertexMatch> matches = matched_beside(device, scene, {-3, 0});
        double total = 0;
        for (VertexMatch& match : matches) {
          match.weight = match.vertex % 7 == 0 ? 3.0f : 0.1f;
          total += match.weight;
        }
        ASSERT_GT(matches.size(), 40u);
        system.set_frame({}, nullptr, {}, matches);
        EXPECT_LE(system.n_matches(), 40);
        EXPECT_GE(system.n_matches(), 30);
        const std::vector<float> rows = system.residuals(scene.state);
        double energy = 0;
        for (size_t i = system.n_point_rows(); i < rows.size(); ++i) energy += double(rows[i]) * rows[i];
        EXPECT_NEAR(energy, scene.options.weights.match * total * 9, 0.05 * scene.options.weights.match * total * 9);

        // Without a total weight there are no shares of it: nothing is used, and nothing beyond the rows there are.
        for (float weight : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
          for (VertexMatch& match : matches) match.weight = weight;
          system.set_frame({}, nullptr, {}, matches);
          EXPECT_EQ(system.n_matches(), 0);
        }
      },
      test::Doubles::kAlsoWithout);
}

}  // namespace
}  // namespace livecap
