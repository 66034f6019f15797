#include "surface/surface_system.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "livecap/error.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"
#include "surface/reference_system.h"

namespace livecap {
namespace {

using test::Scene;

// All terms on: a sphere of 642 vertices (not a multiple of 16), every second kind of vertex flagged, noise everywhere.
Scene busy_scene(const Mesh& mesh = test::icosphere(3, 300, {40, -30, 2000})) {
  Scene s = test::make_scene(mesh, 320, 240, 500);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (uint8_t& p : s.image.pixels) p = uint8_t(random() % 256);
  for (float& c : s.actor.colors) c = uniform(random);
  for (float& r : s.actor.rigidity) {
    const float kind = uniform(random);
    r = kind < 0.3f ? 50.0f : kind < 0.7f ? 1.0f : 2.0f;  // 1: hangs
  }
  test::set_distance(s, [](double x, double y) { return std::hypot(x - 165.3, y - 111.7) - 72.4; });
  for (int i = 0; i < s.n(); ++i) {
    s.visible[i] = i % 3 != 0;
    s.contour[i] = i % 4 == 0;
    s.vertex_part[i] = 1 + i % 2;
    // Every fifth normal points inwards: b_i = -1 there inside the silhouette.
    for (int a = 0; i % 5 == 0 && a < 3; ++a) s.normals[3 * i + a] *= -1;
  }
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) s.part_image[size_t(y) * 320 + x] = x < 150 ? 1 : (x < 200 ? 2 : 0);
  s.matches.assign(LC_MATCH * s.n(), 0.0f);
  for (int i = 0; i < s.n(); ++i) {
    if (i % 7 < 3) continue;
    const auto [u, v] = s.project(s.start, i);
    const float numbers[] = {float(u) + 8 * uniform(random) - 4,
                             float(v) + 8 * uniform(random) - 4,
                             uniform(random),
                             uniform(random) - 0.5f,
                             uniform(random),
                             3 * uniform(random),
                             0.5f + 0.5f * uniform(random)};
    std::copy(std::begin(numbers), std::end(numbers), &s.matches[LC_MATCH * i]);
  }
  test::add_noise(s.start, 12, 1);
  test::add_noise(s.skinned, 5, 2);
  test::add_noise(s.previous, 15, 3);
  test::add_noise(s.before, 15, 4);
  return s;
}

SurfaceOptions smooth_options() {
  SurfaceOptions o;
  o.hanging_rest_share = 0.7f;  // not edge_rest_share
  o.color_threshold = 2.0f;     // no residual sits at the threshold, where float and double may disagree
  return o;
}

double relative_error(const std::vector<float>& found, const Eigen::VectorXd& expected) {
  const Eigen::VectorXd f = Eigen::Map<const Eigen::VectorXf>(found.data(), Eigen::Index(found.size())).cast<double>();
  return (f - expected).norm() / expected.norm();
}

std::vector<double> doubles(const std::vector<float>& v) {
  return {v.begin(), v.end()};
}

TEST(SurfaceSystem, GradientProductAndEnergiesEqualAnAssembledJacobian) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    // The grid's 1024 vertices would make planes of 4096 bytes.
    for (const Mesh& mesh : {test::icosphere(1, 300, {40, -30, 2000}), test::icosphere(3, 300, {40, -30, 2000}),
                             test::grid(32, 32, 15, 2000)}) {
      const Scene s = busy_scene(mesh);
      const test::DeviceScene d(device, s);
      const SurfaceOptions o = smooth_options();
      SurfaceSystem system(device, s.actor, s.camera, o);
      for (const int kernel : {15, 9, 3}) {
        const test::ReferenceSystem expected = test::reference_system(s, o, doubles(s.start), kernel);
        system.begin(d.input());
        system.linearize(d.input(), kernel);
        EXPECT_LT(relative_error(system.right_hand_side(), expected.rhs), test::kSurfaceSystem) << kernel;
        const SurfaceEnergies e = system.energies();
        const double pairs[][2] = {
            {e.photo, expected.energies.photo},       {e.silhouette, expected.energies.silhouette},
            {e.match, expected.energies.match},       {e.smooth, expected.energies.smooth},
            {e.edge, expected.energies.edge},         {e.depth, expected.energies.depth},
            {e.velocity, expected.energies.velocity}, {e.acceleration, expected.energies.acceleration}};
        for (const auto& [found, wanted] : pairs) {
          EXPECT_GT(wanted, 0);
          EXPECT_NEAR(found, wanted, test::kSurfaceSystem * wanted);
        }
        std::vector<float> p(3 * s.n(), 0.0f);
        test::add_noise(p, 1, 11);
        const Eigen::VectorXd pd = Eigen::Map<const Eigen::VectorXf>(p.data(), Eigen::Index(p.size())).cast<double>();
        EXPECT_LT(relative_error(system.product(p), expected.A * pd), test::kSurfaceSystem) << kernel;
      }
    }
  });
}

TEST(SurfaceSystem, EachTermAloneEqualsTheAssembledJacobian) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Scene s = busy_scene();
    const test::DeviceScene d(device, s);
    for (int term = 0; term < 8; ++term) {
      SurfaceOptions o = smooth_options();
      const SurfaceOptions all = o;
      o.w_photo = term == 0 ? all.w_photo : 0;
      o.w_silhouette = term == 1 ? all.w_silhouette : 0;
      o.w_smooth = term == 2 ? all.w_smooth : 0;
      o.w_edge = term == 3 ? all.w_edge : 0;
      o.w_depth = term == 6 ? all.w_depth : 0;
      o.w_match = term == 7 ? all.w_match : 0;
      o.w_velocity = term == 4 ? all.w_velocity : 0;
      o.w_worn_velocity = term == 4 ? all.w_worn_velocity : 0;
      o.w_acceleration = term == 5 ? all.w_acceleration : 0;
      SurfaceSystem system(device, s.actor, s.camera, o);
      const test::ReferenceSystem expected = test::reference_system(s, o, doubles(s.start), 9);
      system.begin(d.input());
      system.linearize(d.input(), 9);
      EXPECT_GT(expected.rhs.norm(), 0) << term;
      EXPECT_LT(relative_error(system.right_hand_side(), expected.rhs), test::kSurfaceSystem) << term;
      std::vector<float> p(3 * s.n(), 0.0f);
      test::add_noise(p, 1, 5);
      const Eigen::VectorXd pd = Eigen::Map<const Eigen::VectorXf>(p.data(), Eigen::Index(p.size())).cast<double>();
      EXPECT_LT(relative_error(system.product(p), expected.A * pd), test::kSurfaceSystem) << term;
    }
  });
}

void expect_textbook_iterations(ocl::DeviceContext& device, const Mesh& mesh) {
  const Scene s = busy_scene(mesh);
  const test::DeviceScene d(device, s);
  const SurfaceOptions o = smooth_options();
  SurfaceSystem system(device, s.actor, s.camera, o);
  const test::ReferenceSystem ref = test::reference_system(s, o, doubles(s.start), 9);
  const auto precondition = [&](const Eigen::VectorXd& r) {
    Eigen::VectorXd z(r.size());
    for (int i = 0; i < s.n(); ++i) {
      const Eigen::Matrix3d block = Eigen::MatrixXd(ref.A.block(3 * i, 3 * i, 3, 3));
      z.segment<3>(3 * i) = block.inverse() * r.segment<3>(3 * i);
    }
    return z;
  };
  for (const int iterations : {1, 4, 7}) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(3 * s.n()), r = ref.rhs, z = precondition(r), p = z;
    double rz = r.dot(z);
    for (int k = 0; k < iterations; ++k) {
      const Eigen::VectorXd q = ref.A * p;
      const double alpha = rz / p.dot(q);
      x += alpha * p;
      r -= alpha * q;
      z = precondition(r);
      const double next = r.dot(z);
      p = z + next / rz * p;
      rz = next;
    }
    system.begin(d.input());
    system.linearize(d.input(), 9);
    system.iterate_pcg(iterations);
    EXPECT_LT(relative_error(system.step(), x), test::kSurfaceSystem) << iterations;
  }
}

TEST(SurfaceSystem, ConjugateGradientsEqualTheTextbookIteration) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    expect_textbook_iterations(device, test::icosphere(3, 300, {40, -30, 2000}));
    // More links than a work-item keeps.
    expect_textbook_iterations(device, test::double_cone(20, 300, {40, -30, 2000}));
  });
}

// A CPU with one compute unit does all iterations in one launch, one with several launches every part of them.
TEST(SurfaceSystem, OneLaunchDoesWhatManyDo) {
  const Scene s = busy_scene();
  std::vector<std::vector<float>> steps;
  for (const int compute_units : {1, 2}) {
    ocl::DeviceInfo info = ocl::select_device("cpu");
    info.compute_units = compute_units;
    ocl::DeviceContext device(info);
    const test::DeviceScene d(device, s);
    SurfaceSystem system(device, s.actor, s.camera, smooth_options());
    for (const int iterations : {1, 5}) {
      system.begin(d.input());
      system.linearize(d.input(), 9);
      system.iterate_pcg(iterations);
      steps.push_back(system.step());
    }
  }
  EXPECT_EQ(steps[0], steps[2]);
  EXPECT_EQ(steps[1], steps[3]);
  EXPECT_NE(steps[0], steps[1]);
}

TEST(SurfaceSystem, ColorThresholdDropsTheResidual) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = test::make_scene(test::icosphere(1, 300, {0, 0, 2000}), 160, 120, 300);
    s.visible.assign(s.n(), 1);
    s.image.pixels.assign(s.image.pixels.size(), 255);
    for (int i = 0; i < s.n(); ++i)
      for (int c = 0; c < 3; ++c) s.actor.colors[3 * i + c] = i % 2 ? 0.95f : 0.80f;  // residual 0.0866 or 0.346
    const test::DeviceScene d(device, s);
    SurfaceOptions o;
    o.color_threshold = 0.2f;
    SurfaceSystem system(device, s.actor, s.camera, o);
    system.begin(d.input());
    system.linearize(d.input(), 9);
    const double expected = o.w_photo * 3 * 0.05 * 0.05 * (s.n() / 2);
    EXPECT_NEAR(system.energies().photo, expected, test::kSurfaceSystem * expected);
  });
}

TEST(SurfaceSystem, ColorsAtIntegerPositionsAreOpenCvGaussianBlur) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const int w = 57, h = 41;
    cv::Mat image(h, w, CV_8UC3);
    cv::randu(image, 0, 256);
    const std::vector<uint8_t> bytes(image.data, image.data + size_t(3) * w * h);
    const ocl::Buffer<uint8_t> rgb(device, bytes);
    std::vector<float> positions;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) positions.insert(positions.end(), {float(x), float(y)});
    const int n = w * h;
    const ocl::Buffer<float> at(device, positions);
    ocl::Buffer<float> out(device, size_t(9) * n);
    ocl::Kernel kernel(device, "surface/surface.cl", "sample_colors");
    cv::Mat real;
    image.convertTo(real, CV_64FC3, 1 / 255.0);
    for (const int size : {1, 3, 9, 15}) {
      const double sigma = gaussian_sigma(size);
      kernel.launch(n, 1, n, w, h, size / 2, float(1 / (sigma * sigma)), rgb, at, out);
      cv::Mat blurred;
      cv::GaussianBlur(real, blurred, cv::Size(size, size), sigma, sigma, cv::BORDER_REPLICATE);
      const std::vector<float> found = out.read_all();
      double worst = 0;
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
          for (int c = 0; c < 3; ++c)
            worst = std::max(worst, std::abs(found[9 * (y * w + x) + c] - blurred.at<cv::Vec3d>(y, x)[c]));
      EXPECT_LT(worst, test::kBlurredColor) << size;
    }
  });
}

TEST(SurfaceSystem, ColorsAreContinuousBetweenPixels) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = busy_scene(test::icosphere(1, 300, {40, -30, 2000}));
    const ocl::Buffer<uint8_t> rgb(device, s.image.pixels);
    std::vector<float> positions;
    for (int k = 0; k < 400; ++k)
      positions.insert(positions.end(), {150.5f + 0.01f * float(k), 100.25f + 0.01f * float(k)});
    const ocl::Buffer<float> at(device, positions);
    ocl::Buffer<float> out(device, 9 * 400);
    ocl::Kernel kernel(device, "surface/surface.cl", "sample_colors");
    for (const int size : {3, 9, 15}) {
      const double sigma = gaussian_sigma(size);
      kernel.launch(400, 1, 400, s.camera.width, s.camera.height, size / 2, float(1 / (sigma * sigma)), rgb, at, out);
      const std::vector<float> found = out.read_all();
      for (int k = 0; k + 1 < 400; ++k)
        for (int c = 0; c < 3; ++c) {
          // The trapezoidal rule over the two gradients must explain the difference of the two values.
          const float* a = &found[9 * k];
          const float* b = &found[9 * (k + 1)];
          const double explained = 0.5 * 0.01 * (a[3 + c] + b[3 + c] + a[6 + c] + b[6 + c]);
          EXPECT_NEAR(b[c] - a[c], explained, test::kBlurredGradientStep) << size << " " << k;
        }
    }
  });
}

TEST(SurfaceSystem, ALateFailureGivesTheStartBack) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Scene s = busy_scene();
    test::DeviceScene d(device, s);
    SurfaceSystem system(device, s.actor, s.camera, {});
    ocl::Buffer<float> out(device, s.start.size());
    const auto step = [&] {
      system.linearize(d.input(), 9);
      system.iterate_pcg(4);
      system.move();
    };
    system.begin(d.input());
    step();
    system.finish(d.input(), out);
    EXPECT_EQ(system.status(), SurfaceStatus::kOk);
    EXPECT_NE(out.read_all(), s.start);
    d.frame.signed_distance.fill(std::nanf(""));
    step();
    d.frame.signed_distance.fill(10.0f);
    step();
    system.finish(d.input(), out);
    EXPECT_EQ(system.status(), SurfaceStatus::kNonFinite);
    EXPECT_EQ(out.read_all(), s.start);
  });
}

TEST(SurfaceSystem, OptionsAndSizesAreChecked) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = busy_scene(test::icosphere(1, 300, {40, -30, 2000}));
    SurfaceOptions o;
    o.gaussian_kernels = {4};
    EXPECT_THROW(SurfaceSystem(device, s.actor, s.camera, o), ConfigError);
    o = {};
    o.w_edge = -1;
    EXPECT_THROW(SurfaceSystem(device, s.actor, s.camera, o), ConfigError);
    for (const float share : {-0.1f, 1.1f, std::nanf("")}) {
      for (float SurfaceOptions::*field : {&SurfaceOptions::edge_rest_share, &SurfaceOptions::hanging_rest_share}) {
        o = {};
        o.*field = share;
        EXPECT_THROW(SurfaceSystem(device, s.actor, s.camera, o), ConfigError) << share;
      }
    }
    SurfaceSystem system(device, s.actor, s.camera, {});
    s.visible.resize(3);
    const test::DeviceScene d(device, s);
    EXPECT_THROW(system.begin(d.input()), LogicError);
  });
}

}  // namespace
}  // namespace livecap
