// How bright a bare forearm is: a square before the camera, hinged as one, in pictures of known brightness.
#include "match/skin_shading.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "livecap/error.h"
#include "raster/visibility.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr int kArmCells = 16;
constexpr double kArmHalf = 200, kArmDepth = 2000;  // mm
constexpr float kColor = 0.5f;
constexpr int kArmLabel = 14, kClothesLabel = 5;

Camera square_camera() {
  return {.width = 160, .height = 160, .fx = 600, .fy = 600, .cx = 79.5, .cy = 79.5};
}

int column(int vertex) {
  return vertex % (kArmCells + 1);
}

// Its right half wears a sleeve. tilt: about the x axis, the upper edge away from the camera.
Actor square(double tilt = 0) {
  Actor actor;
  for (int j = 0; j <= kArmCells; ++j) {
    for (int i = 0; i <= kArmCells; ++i) {
      const double x = (2.0 * i / kArmCells - 1) * kArmHalf, y = (2.0 * j / kArmCells - 1) * kArmHalf;
      for (double value : {x, y * std::cos(tilt), kArmDepth - y * std::sin(tilt)})
        actor.mesh.positions.push_back(float(value));
      actor.labels.push_back(i <= kArmCells / 2 ? kArmLabel : kClothesLabel);
      actor.colors.insert(actor.colors.end(), 3, kColor);
      actor.skin.bones.insert(actor.skin.bones.end(), {1, 0, 0, 0});
      actor.skin.weights.insert(actor.skin.weights.end(), {1, 0, 0, 0});
    }
  }
  for (int j = 0; j < kArmCells; ++j) {
    for (int i = 0; i < kArmCells; ++i) {
      const int a = j * (kArmCells + 1) + i, c = a + kArmCells + 1;
      actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, a + 1, a + 1, c, c + 1});
    }
  }
  actor.skeleton.bones = {{"pelvis", -1, {0, 0, 0}}, {"left_elbow", 0, {0, 0, 0}}};
  return actor;
}

using Rgb = std::array<uint8_t, 3>;

// The whole picture of this colour; the silhouette covers all of it, or its upper half.
std::vector<SkinSample> measure(ocl::DeviceContext& device, const Actor& actor, SkinShading& shading, Rgb rgb,
                                bool upper_half_only = false) {
  const Camera camera = square_camera();
  DeviceFrame frame(device, camera.width, camera.height);
  std::vector<uint8_t> pixels(frame.rgb.size());
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = rgb[i % 3];
  frame.rgb.write(pixels);
  std::vector<float> distance;
  for (int y = 0; y < camera.height; ++y)
    distance.insert(distance.end(), camera.width, upper_half_only ? float(y - 80) : -80.0f);
  frame.signed_distance.write(distance);
  DepthRasterizer raster(device, actor.mesh, camera.width, camera.height);
  SurfaceVisibility visibility(device, actor.mesh);
  const ocl::Buffer<float> positions(device, actor.mesh.positions);
  const ocl::Buffer<float> normals(device, vertex_normals(actor.mesh.positions, actor.mesh.triangles));
  raster.render(positions, camera);
  visibility.find_visible(positions, normals, raster);
  shading.measure(frame, raster, positions, normals, visibility.visible());
  return shading.read();
}

std::vector<SkinSample> measure(ocl::DeviceContext& device, const Actor& actor, SkinShading& shading, int grey,
                                bool upper_half_only = false) {
  return measure(device, actor, shading, Rgb{uint8_t(grey), uint8_t(grey), uint8_t(grey)}, upper_half_only);
}

TEST(SkinShading, BrightnessIsLinearLightByAlbedoOfSkinAlone) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Actor actor = square();
    SkinShading shading(device, actor, square_camera(), SkinShadingOptions{});
    ASSERT_TRUE(shading.usable());
    const std::vector<SkinSample> samples = measure(device, actor, shading, 102);
    ASSERT_GT(samples.size(), 100u);
    double area = 0;
    for (const SkinSample& s : samples) {
      EXPECT_NEAR(s.brightness, 0.16 / 0.25, 1e-5);  // (102 / 255)^2 by 0.5^2
      EXPECT_NEAR((s.normal - Eigen::Vector3f(0, 0, -1)).norm(), 0, 1e-5);
      area += s.area_px;
    }
    // 8 of 16 columns, less the one beside the sleeve and the outer edges, each half a cell wide; 7.5 px a cell.
    EXPECT_GT(area, 5.5 * 14 * 56);
    EXPECT_LT(area, 8 * 15 * 57);
    EXPECT_LT(measure(device, actor, shading, 102, true).size(), samples.size() * 0.55);
  });
}

// Once the skin's tint is known, a picture of another tint does not show skin: by red and blue, each by itself.
TEST(SkinShading, WhatHasAnotherColourIsNoSkin) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Actor actor = square();
    SkinShading shading(device, actor, square_camera(), SkinShadingOptions{});
    for (int f = 0; f < 10; ++f) shading.learn(measure(device, actor, shading, {102, 102, 102}));
    const auto n_shaded = [&](Rgb rgb) { return shading.shaded(measure(device, actor, shading, rgb)).size(); };
    const size_t all = n_shaded({102, 102, 102});
    EXPECT_GT(all, 100u);
    EXPECT_EQ(n_shaded({60, 60, 60}), all);  // in the shade
    EXPECT_EQ(n_shaded({105, 102, 99}), all);
    EXPECT_EQ(n_shaded({140, 102, 102}), 0u);
    EXPECT_EQ(n_shaded({102, 102, 60}), 0u);
    EXPECT_EQ(n_shaded({0, 0, 0}), 0u);
    const std::vector<SkinSample> seen = measure(device, actor, shading, {140, 102, 60});
    ASSERT_EQ(seen.size(), all);
    const double r = 140. * 140 / 65025, g = 102. * 102 / 65025, b = 60. * 60 / 65025;
    const double y = 0.299 * r + 0.587 * g + 0.114 * b;
    for (const SkinSample& s : seen) {
      EXPECT_LT(s.area_px, 0);
      EXPECT_NEAR(s.brightness, y / 0.25, 1e-5);
      EXPECT_NEAR(s.tint.x(), r / y, 1e-5);
      EXPECT_NEAR(s.tint.y(), b / y, 1e-5);
    }
    EXPECT_EQ(shading.misfit(seen, 1, Eigen::Matrix3d::Identity(), 2), 0);
  });
}

TEST(SkinShading, NothingIsSeenEdgeOnOrOfAnActorInClothes) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor steep = square(1.3);
    SkinShading shading(device, steep, square_camera(), SkinShadingOptions{});
    EXPECT_TRUE(measure(device, steep, shading, 102).empty());
    Actor clothed = square();
    for (uint8_t& label : clothed.labels) label = kClothesLabel;
    SkinShading none(device, clothed, square_camera(), SkinShadingOptions{});
    EXPECT_FALSE(none.usable());
    EXPECT_TRUE(measure(device, clothed, none, 102).empty());
    EXPECT_TRUE(none.shaded({}).empty());
    SkinShadingOptions bad;
    bad.limb_area_px = 0;
    EXPECT_THROW(SkinShading(device, clothed, square_camera(), bad), ConfigError);
  });
}

// Light from above, learned from squares of many tilts: the one seen last is told from its mirror image.
TEST(SkinShading, TheLightTellsATiltFromItsMirrorImage) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor actor = square();
    SkinShading shading(device, actor, square_camera(), SkinShadingOptions{});
    const auto grey = [](double tilt) {
      const Eigen::Vector3d n(0, -std::sin(tilt), -std::cos(tilt));
      return int(std::lround(255 * std::sqrt(0.25 * (0.5 - 0.4 * n.y()))));
    };
    for (int f = 0; f < 30; ++f) {
      const double tilt = 0.9 * std::sin(0.7 * f);
      EXPECT_EQ(shading.shaded(measure(device, square(tilt), shading, grey(tilt))).empty(), f < 6) << f;
      shading.learn(measure(device, square(tilt), shading, grey(tilt)));
    }
    const double tilt = 0.5;
    const std::vector<SkinSample> samples = measure(device, square(tilt), shading, grey(tilt));
    const Eigen::Matrix3d mirror = Eigen::AngleAxisd(-2 * tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const double right = shading.misfit(samples, 1, Eigen::Matrix3d::Identity(), 2);
    EXPECT_LT(right, 0.5);
    EXPECT_GT(std::max(shading.misfit(samples, 1, mirror, 2), shading.misfit(samples, 1, mirror.transpose(), 2)), 4);
    EXPECT_EQ(shading.misfit(samples, 0, mirror, 2), 0);  // nothing of it is seen
    double weight = 0;
    for (const ShadedVertex& vertex : shading.shaded(samples)) {
      EXPECT_EQ(actor.labels[vertex.vertex], kArmLabel);
      weight += vertex.weight;
    }
    EXPECT_NEAR(weight, 1, 1e-4);  // of one whole limb
    shading.forget();
    EXPECT_TRUE(shading.shaded(samples).empty());
  });
}

}  // namespace
}  // namespace livecap
