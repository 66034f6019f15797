#include "surface/surface_solver.h"

#include <gtest/gtest.h>

#include <cstring>

#include "actor/skinner.h"
#include "support/kernel_bodies.h"
#include "support/launched_kernels.h"
#include "support/tolerances.h"
#include "surface/reference_system.h"

namespace livecap {
namespace {

using test::Scene;

std::vector<float> solved(ocl::DeviceContext& device, const Scene& s, const SurfaceOptions& options = {},
                          bool temporal = false, SurfaceResult* result = nullptr) {
  const test::DeviceScene d(device, s);
  SurfaceSolver solver(device, s.actor, s.camera, options);
  const SurfaceResult r = solver.solve(d.input(temporal, false));
  std::vector<float> vertices = r.vertices->read_all();
  if (result) {
    *result = r;
    result->vertices = nullptr;  // the solver ends here
  }
  return vertices;
}

// A sphere seen as a circle of 75 px; the silhouette is a circle of `radius_px` about the same point.
Scene solver_ball(double radius_px, int subdivisions = 3) {
  Scene s = test::make_scene(test::icosphere(subdivisions, 300, {0, 0, 2000}), 321, 241, 490);
  test::set_distance(s, [&](double x, double y) { return std::hypot(x - 160, y - 120) - radius_px; });
  test::mark_rim(s, 0.08);
  return s;
}

double worst_contour_distance(const Scene& s, const std::vector<float>& v, double radius_px) {
  double worst = 0;
  for (int i = 0; i < s.n(); ++i) {
    if (!s.contour[i]) continue;
    const auto uv = s.project(v, i);
    worst = std::max(worst, std::abs(std::hypot(uv[0] - 160, uv[1] - 120) - radius_px));
  }
  return worst;
}

double texture(double x, double y, int c) {
  return 0.5 + 0.22 * std::sin(0.13 * x + 0.05 * y + c) + 0.22 * std::cos(0.11 * y - 0.04 * x + 2 * c);
}

// A textured plane whose picture is moved by (dx, dy) px. One vertex every 4 px.
Scene moved_plane(double dx, double dy) {
  Scene s = test::make_scene(test::grid(40, 30, 16, 2000), 240, 180, 500);
  s.visible.assign(s.n(), 1);
  for (int i = 0; i < s.n(); ++i) {
    const auto uv = s.project(s.start, i);
    for (int c = 0; c < 3; ++c) s.actor.colors[3 * i + c] = float(texture(uv[0], uv[1], c));
  }
  test::set_image(s, [&](double x, double y, int c) { return texture(x - dx, y - dy, c); });
  return s;
}

TEST(SurfaceSolver, ConvergesToTheMinimumOfADirectSolver) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = solver_ball(79);
    for (int i = 0; i < s.n(); ++i) {
      const auto uv = s.project(s.start, i);
      for (int c = 0; c < 3; ++c) s.actor.colors[3 * i + c] = float(texture(uv[0] + 1.5, uv[1] - 1, c));
      if (i % 5 == 0) s.actor.rigidity[i] = 50.0f;
    }
    test::set_image(s, texture);
    test::add_noise(s.start, 2, 3);
    test::add_noise(s.previous, 4, 4);
    test::add_noise(s.before, 4, 5);
    s.part_image.assign(s.part_image.size(), 0);
    SurfaceOptions o;
    o.color_threshold = 2.0f;
    o.gaussian_kernels.assign(15, 9);
    o.pcg_iterations = 60;
    SurfaceResult result;
    const std::vector<float> v = solved(device, s, o, true, &result);
    EXPECT_EQ(result.status, SurfaceStatus::kOk);

    std::vector<double> x(s.start.begin(), s.start.end());
    const double initial = test::reference_system(s, o, x, 9).energies.total();
    for (int step = 0; step < 15; ++step) {
      const test::ReferenceSystem system = test::reference_system(s, o, x, 9);
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(system.A);
      const Eigen::VectorXd delta = ldlt.solve(system.rhs);
      for (size_t k = 0; k < x.size(); ++k) x[k] += delta[Eigen::Index(k)];
    }
    const double minimum = test::reference_system(s, o, x, 9).energies.total();
    const double ours = test::reference_system(s, o, {v.begin(), v.end()}, 9).energies.total();
    EXPECT_LT(minimum, 0.5 * initial);
    EXPECT_NEAR(ours, minimum, test::kSurfaceMinimum * minimum);
    EXPECT_NEAR(result.energies.total(), ours, test::kSurfaceSystem * ours);
  });
}

TEST(SurfaceSolver, SilhouettePullsTheContourIntoPlace) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const double radius : {70.5, 79.0}) {
      const Scene s = solver_ball(radius);
      SurfaceOptions o;
      o.w_photo = 0;
      EXPECT_GT(worst_contour_distance(s, s.start, radius), 3.5);
      EXPECT_LT(worst_contour_distance(s, solved(device, s, o), radius), 1.0) << radius;
      o.pcg_iterations = 60;
      EXPECT_LT(worst_contour_distance(s, solved(device, s, o), radius), test::kContourPx) << radius;
      o.w_silhouette = 0;
      EXPECT_EQ(worst_contour_distance(s, solved(device, s, o), radius), worst_contour_distance(s, s.start, radius));
    }
  });
}

TEST(SurfaceSolver, OtherPartsRegionSwitchesTheSilhouetteOff) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = solver_ball(80);
    s.part_image.assign(s.part_image.size(), 2);
    SurfaceOptions o;
    o.w_photo = 0;
    const test::DeviceScene d(device, s);
    SurfaceSolver solver(device, s.actor, s.camera, o);
    const auto largest_move = [&](const std::vector<float>& v) {
      double worst = 0;
      for (size_t k = 0; k < v.size(); ++k) worst = std::max(worst, std::abs(double(v[k]) - s.start[k]));
      return worst;
    };
    EXPECT_LT(largest_move(solver.solve(d.input(false, true)).vertices->read_all()), test::kSurfaceRestMm);
    EXPECT_GT(largest_move(solver.solve(d.input(false, false)).vertices->read_all()), 1.0);
  });
}

// Mean distance of the inner vertices from where a picture moved by (dx, dy) wants them, px.
double translation_error(const Scene& s, const std::vector<float>& v, double dx, double dy) {
  double error = 0;
  int n_inner = 0;
  for (int i = 0; i < s.n(); ++i) {
    const int column = i % 40, row = i / 40;
    if (column < 5 || column >= 35 || row < 5 || row >= 25) continue;
    const auto a = s.project(s.start, i), b = s.project(v, i);
    error += std::hypot(b[0] - a[0] - dx, b[1] - a[1] - dy);
    ++n_inner;
  }
  return error / n_inner;
}

TEST(SurfaceSolver, PhotometricTermRecoversATranslation) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const double dx = 2.4, dy = -1.8;  // 3 px
    const Scene s = moved_plane(dx, dy);
    EXPECT_LT(translation_error(s, solved(device, s), dx, dy), 0.5 * 3.0);
    SurfaceOptions patient;
    patient.pcg_iterations = 60;
    EXPECT_LT(translation_error(s, solved(device, s, patient), dx, dy), test::kRecoveredTranslationPx);
    patient.w_photo = 0;
    EXPECT_NEAR(translation_error(s, solved(device, s, patient), dx, dy), 3.0, test::kSurfaceRestMm);
  });
}

TEST(SurfaceSolver, RigidMaterialMovesLess) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = test::make_scene(test::grid(41, 31, 16, 2000), 240, 180, 500);
    // A line of contour vertices across both halves, pulled down by a silhouette edge below it.
    for (int i = 0; i < s.n(); ++i) {
      s.actor.rigidity[i] = i % 41 < 20 ? 200.0f : 1.0f;
      s.contour[i] = i / 41 == 15 && i % 3 == 0;
      s.normals[3 * i + 1] = 1.0f;
      s.normals[3 * i + 2] = 0.0f;
    }
    test::set_distance(s, [](double, double y) { return y - 94.5; });
    const std::vector<float> v = solved(device, s);
    double rigid = 0, soft = 0;
    for (int i = 0; i < s.n(); ++i) {
      if (!s.contour[i]) continue;
      (i % 41 < 20 ? rigid : soft) += std::abs(v[3 * i + 1] - s.start[3 * i + 1]);
    }
    EXPECT_GT(soft, 0);
    EXPECT_LT(rigid, 0.5 * soft);
  });
}

TEST(SurfaceSolver, RepeatsBitForBit) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = moved_plane(1.2, 0.7);
    test::add_noise(s.start, 3, 1);
    const test::DeviceScene d(device, s);
    SurfaceSolver solver(device, s.actor, s.camera);
    const SurfaceResult first = solver.solve(d.input());
    const std::vector<float> a = first.vertices->read_all();
    const SurfaceEnergies e = first.energies;
    const SurfaceResult second = solver.solve(d.input());
    EXPECT_EQ(second.vertices->read_all(), a);
    EXPECT_EQ(second.energies.total(), e.total());
    EXPECT_EQ(solved(device, s, {}, true), a);
    EXPECT_NE(a, s.start);
  });
}

TEST(SurfaceSolver, WithoutDataTheSkinnedMeshStays) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const int subdivisions : {0, 1, 2}) {  // 12, 42, 162 vertices
      Scene s = test::make_scene(test::icosphere(subdivisions, 300, {0, 0, 2000}), 64, 48, 100);
      const std::vector<float> v = solved(device, s, {}, true);
      for (size_t k = 0; k < v.size(); ++k) EXPECT_NEAR(v[k], s.start[k], test::kSurfaceRestMm);
    }
  });
}

// Loose vertices that the last frame draws aside and away from the camera: what hangs follows, the rest only aside.
TEST(SurfaceSolver, WhatDoesNotHangKeepsItsDepth) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Mesh mesh;
    mesh.positions = {300, -200, 2000, -400, 100, 2500};
    Scene s = test::make_scene(mesh, 64, 48, 100);
    s.actor.rigidity = {1, 2};
    s.previous = s.before = {310, -190, 2010, -390, 110, 2510};
    SurfaceOptions o;
    o.w_acceleration = 0;
    const std::vector<float> v = solved(device, s, o, true);
    for (int i = 0; i < 2; ++i) {
      const auto point = [i](const std::vector<float>& p) {
        return Eigen::Vector3d(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
      };
      const Eigen::Vector3d start = point(s.start), sight = start.normalized(), drawn = point(s.previous) - start;
      const double along = sight.dot(drawn);
      // Of two springs between both ends.
      const double kept = i == 0 ? 1 : o.w_worn_velocity / (o.w_worn_velocity + o.w_depth);
      const Eigen::Vector3d wanted = start + drawn + (kept - 1) * along * sight;
      EXPECT_LT((point(v) - wanted).norm(), test::kSurfaceSystem * 10 * 30) << i;
    }
  });
}

TEST(SurfaceSolver, DegenerateMeshesAreSolved) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const int n : {1, 15, 16, 17}) {  // loose vertices, no triangle
      Mesh mesh;
      for (int i = 0; i < n; ++i) mesh.positions.insert(mesh.positions.end(), {float(i), 0.0f, 2000.0f});
      Scene s = test::make_scene(mesh, 64, 48, 100);
      for (size_t k = 0; k < s.previous.size(); ++k) s.previous[k] = s.before[k] = s.start[k] + 10;
      SurfaceOptions o;
      o.w_acceleration = 0;
      o.w_depth = 0;
      const std::vector<float> v = solved(device, s, o, true);
      for (size_t k = 0; k < v.size(); ++k) EXPECT_NEAR(v[k], s.previous[k], test::kSurfaceSystem * 10 * 30) << n;
    }
    // All neighbours on one point.
    Scene s = test::make_scene(test::icosphere(1, 300, {0, 0, 2000}), 64, 48, 100);
    for (size_t k = 0; k < s.start.size(); ++k) s.start[k] = k % 3 == 2 ? 2000.0f : 0.0f;
    SurfaceResult result;
    const std::vector<float> v = solved(device, s, {}, false, &result);
    EXPECT_EQ(result.status, SurfaceStatus::kOk);
    for (const float x : v) EXPECT_TRUE(std::isfinite(x));
  });
}

TEST(SurfaceSolver, NonFiniteStepsGiveTheStartBack) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const float bad : {std::nanf(""), INFINITY, 1e30f}) {
      Scene s = moved_plane(1, 1);
      s.previous[7] = bad;
      SurfaceResult result;
      const std::vector<float> v = solved(device, s, {}, true, &result);
      EXPECT_EQ(result.status, SurfaceStatus::kNonFinite) << bad;
      EXPECT_EQ(v, s.start);
      EXPECT_EQ(result.energies.total(), 0);
    }
    // The next frame is not affected.
    Scene s = moved_plane(1, 1);
    const test::DeviceScene good(device, s);
    s.previous[7] = std::nanf("");
    const test::DeviceScene broken(device, s);
    SurfaceSolver solver(device, s.actor, s.camera);
    const std::vector<float> expected = solver.solve(good.input()).vertices->read_all();
    EXPECT_EQ(solver.solve(broken.input()).status, SurfaceStatus::kNonFinite);
    const SurfaceResult again = solver.solve(good.input());
    EXPECT_EQ(again.status, SurfaceStatus::kOk);
    EXPECT_EQ(again.vertices->read_all(), expected);
    EXPECT_EQ(solver.solve(broken.input(false)).status, SurfaceStatus::kOk) << "previous is not given";
  });
}

TEST(SurfaceSolver, OneStepIsCapped) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = test::make_scene(test::icosphere(1, 300, {0, 0, 2000}), 64, 48, 100);
    for (float& x : s.previous) x += 5000;
    SurfaceOptions o;
    o.w_acceleration = 0;
    o.max_step_mm = 20;
    const std::vector<float> v = solved(device, s, o, true);
    double worst = 0;
    for (int i = 0; i < s.n(); ++i) {
      double move = 0;
      for (int a = 0; a < 3; ++a) move += std::pow(v[3 * i + a] - s.start[3 * i + a], 2);
      worst = std::max(worst, std::sqrt(move));
    }
    EXPECT_GT(worst, 50);
    EXPECT_LT(worst, 60.01);
  });
}

TEST(SurfaceSolver, VerticesOutsideThePictureHaveNoData) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = solver_ball(80);
    for (size_t k = 0; k < s.start.size(); k += 3) {
      s.start[k] += 1.0e6f;
      s.skinned[k] += 1.0e6f;
    }
    s.visible.assign(s.visible.size(), 1);
    SurfaceResult result;
    solved(device, s, {}, false, &result);
    EXPECT_EQ(result.status, SurfaceStatus::kOk);
    EXPECT_EQ(result.energies.photo, 0);
    EXPECT_EQ(result.energies.silhouette, 0);
  });
}

TEST(SurfaceSolver, SelfTestPasses) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const auto results = surface_self_test(device);
    EXPECT_GE(results.size(), 10u);
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
    test::expect_every_kernel_launched(device.info(), "surface/surface.cl", surface_self_test);
    test::expect_every_kernel_launched(device.info(), "surface/slices.cl", [](ocl::DeviceContext& traced) {
      surface_self_test(traced);
      skinner_self_test(traced);
    });
  });
}

}  // namespace
}  // namespace livecap
