// Matches of a textured plane against pictures of it that this file draws by itself: a ray through every pixel.
#include "match/texture_matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "livecap/error.h"
#include "match/plane_scene.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using namespace test;  // plane_scene.h

Matches find_all(ocl::DeviceContext& device, const Actor& actor, const Drawing& drawing, int level,
                 const MatchOptions& options = {}) {
  const Camera camera = plane_camera();
  DeviceFrame frame(device, camera.width, camera.height);
  frame.upload(drawing.silhouette, drawing.picture);
  DepthRasterizer raster(device, actor.mesh, camera.width, camera.height);
  const ocl::Buffer<float> positions(device, actor.mesh.positions);
  std::vector<float> toward(actor.mesh.positions.size(), 0.0f);
  for (size_t i = 2; i < toward.size(); i += 3) toward[i] = -1;
  const ocl::Buffer<float> normals(device, toward);
  const ocl::Buffer<int32_t> visible(device, std::vector<int32_t>(actor.n_vertices(), 1));
  const ocl::Buffer<float> share(device, std::vector<float>(actor.n_vertices(), 1.0f));
  TextureMatcher matcher(device, actor, camera, options);
  raster.render(positions, camera);
  matcher.set_picture(frame, drawing.silhouette.box);
  matcher.match(raster, positions, normals, visible, share, level);
  return matcher.read();
}

std::vector<VertexMatch> find(ocl::DeviceContext& device, const Actor& actor, const Drawing& drawing, int level) {
  return find_all(device, actor, drawing, level).found;
}

bool well_inside(int vertex) {
  const int i = vertex % (kPlaneCells + 1), j = vertex / (kPlaneCells + 1);
  return std::min(i, j) >= 4 && std::max(i, j) <= kPlaneCells - 4;
}

// Distances of the inner vertices' matches from where they should be, along u and v.
struct Errors {
  std::vector<double> u, v;
};

Errors errors(const Actor& actor, const std::vector<VertexMatch>& matches, double dx, double dy) {
  const Camera camera = plane_camera();
  Errors e;
  for (const VertexMatch& match : matches) {
    if (!well_inside(match.vertex)) continue;
    const float* p = &actor.mesh.positions[3 * size_t(match.vertex)];
    e.u.push_back(std::abs(match.u_px - (camera.fx * p[0] / p[2] + camera.cx + dx)));
    e.v.push_back(std::abs(match.v_px - (camera.fy * p[1] / p[2] + camera.cy + dy)));
  }
  return e;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return INFINITY;
  std::sort(values.begin(), values.end());
  return values[size_t(q * double(values.size() - 1))];
}

constexpr size_t kInner = (kPlaneCells - 7) * (kPlaneCells - 7);

TEST(TextureMatcher, FindsSmallMovesAtFullResolutionWhateverTheLight) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(1);
    const Actor actor = plane_actor(texture);
    for (const auto& [left, right] : {std::pair(1.0, 1.0), std::pair(0.9, 0.35)}) {
      const auto matches = find(device, actor, draw(plane_camera(), texture, 1.3, -0.8, left, right), 0);
      const Errors e = errors(actor, matches, 1.3, -0.8);
      EXPECT_GE(e.u.size(), 0.95 * kInner);
      // The picture is drawn with the nearest texel.
      EXPECT_LT(quantile(e.u, 0.5), 0.25);
      EXPECT_LT(quantile(e.v, 0.5), 0.25);
      EXPECT_LT(quantile(e.u, 0.9), 0.5);
      EXPECT_LT(quantile(e.v, 0.9), 0.5);
    }
  });
}

// A mask whose edge goes through the patches of the second and the last but one column: they are found, and not further
// inside. (Were nobody a grey, half of them would be found, 0.65 px inwards. What is left is of the windows of
// contrast, which end there for the camera alone.)
TEST(TextureMatcher, WhereNobodyIsNothingIsTold) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(8, 20);
    const Actor actor = plane_actor(texture);
    const Camera camera = plane_camera();
    Drawing drawing = draw(camera, texture, 0, 0, 1, 1);
    ImageGray mask{camera.width, camera.height, {}};
    for (const float distance : drawing.silhouette.signed_distance) mask.pixels.push_back(distance < -11 ? 255 : 0);
    drawing.silhouette = make_silhouette(mask);
    double inwards_px = 0, weight = 0;
    int n = 0;
    for (const VertexMatch& match : find(device, actor, drawing, 0)) {
      const int i = match.vertex % (kPlaneCells + 1), j = match.vertex / (kPlaneCells + 1);
      if (std::min(j, kPlaneCells - j) < 4 || std::min(i, kPlaneCells - i) != 1) continue;
      const float* p = &actor.mesh.positions[3 * size_t(match.vertex)];
      const double right_px = match.u_px - (camera.fx * p[0] / p[2] + camera.cx);
      inwards_px += match.weight * (i == 1 ? right_px : -right_px);
      weight += match.weight;
      ++n;
    }
    EXPECT_GE(n, 22);
    EXPECT_LT(std::abs(inwards_px), 0.4 * weight);
  });
}

TEST(TextureMatcher, WhatIsNotMatchedIsCounted) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(1);
    const Actor actor = plane_actor(texture);
    const Matches same = find_all(device, actor, draw(plane_camera(), texture, 0, 0, 1, 1), 0);
    double matched = 0;
    for (const VertexMatch& match : same.found) matched += match.weight;
    const Matches other = find_all(device, actor, draw(plane_camera(), noise(9), 0, 0, 1, 1), 0);
    double by_chance = 0;
    for (const VertexMatch& match : other.found) by_chance += match.weight;
    EXPECT_LT(same.missed_weight, 0.3 * matched);
    EXPECT_GT(other.missed_weight, 0.8 * (matched + same.missed_weight));
    EXPECT_NEAR(same.seen_weight, matched + same.missed_weight, test::kTermResidual * matched);
    // Both see the same surface.
    EXPECT_NEAR(by_chance + other.missed_weight, matched + same.missed_weight, test::kTermResidual * matched);
  });
}

// With a least correlation c0 a weight times (1 - c0) is the area times (correlation - c0): on one line over c0, which
// falls by the area.
TEST(TextureMatcher, AMatchCountsByHowFarItsCorrelationIsAboveTheLeast) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(9);
    const Actor actor = plane_actor(texture);
    const Drawing drawing = draw(plane_camera(), texture, 0.4, 0.3, 1, 1);
    std::map<int, std::vector<double>> on_lines;
    for (const float least : {0.5f, 0.6f, 0.8f}) {
      MatchOptions options;
      options.min_correlation = least;
      for (const VertexMatch& match : find_all(device, actor, drawing, 0, options).found)
        on_lines[match.vertex].push_back(match.weight * (1 - least));
    }
    int n_compared = 0;
    double correlations = 0;
    for (const auto& [vertex, at] : on_lines) {
      if (at.size() < 3) continue;  // below one of them
      const double area = (at[0] - at[1]) / 0.1;
      EXPECT_GT(area, 0);
      EXPECT_NEAR((at[1] - at[2]) / 0.2, area, test::kMatchWeight * area) << vertex;
      const double correlation = 0.8 + at[2] / area;  // where the line ends
      EXPECT_LT(correlation, 1 + test::kMatchWeight);
      correlations += correlation;
      ++n_compared;
    }
    EXPECT_GT(n_compared, kInner);
    EXPECT_LT(correlations / n_compared, 0.99) << "weights that do not fall with the correlation end at 1";
  });
}

// align() and match_vertex() of kernels/match, each behind its own pictures: moves near and far, other light, and
// nothing to be found.
TEST(TextureMatcher, BodiesOfCpusAndGpusFindTheSame) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const std::string& selector : test::device_selectors()) {
    ocl::DeviceInfo info = ocl::select_device(selector);
    if (!info.is_cpu) continue;
    ocl::DeviceContext as_cpu(info);
    info.is_cpu = false;
    ocl::DeviceContext as_gpu(info);
    for (int i = 0; i < 9; ++i) {
      SCOPED_TRACE(i);
      const int level = i % (LC_MATCH_LEVELS + 1);
      const std::vector<double> texture = noise(20 + i, 20 >> level);
      const Actor actor = plane_actor(texture);
      const double far = i < 6 ? 3 << level : 30;
      const Drawing drawing = draw(plane_camera(), i == 5 ? noise(1) : texture, far * uniform(rng), far * uniform(rng),
                                   0.7 + 0.3 * uniform(rng), 0.7 + 0.3 * uniform(rng));
      const Matches cpu = find_all(as_cpu, actor, drawing, level), gpu = find_all(as_gpu, actor, drawing, level);
      ASSERT_EQ(cpu.found.size(), gpu.found.size());
      if (i < 5) EXPECT_GT(cpu.found.size(), kInner / 2);
      EXPECT_NEAR(cpu.missed_weight, gpu.missed_weight, test::kMatchBodies * cpu.missed_weight);
      for (size_t k = 0; k < cpu.found.size(); ++k) {
        const VertexMatch &a = cpu.found[k], &b = gpu.found[k];
        ASSERT_EQ(a.vertex, b.vertex);
        for (const auto& [got, expected] : {std::pair(b.u_px, a.u_px), std::pair(b.v_px, a.v_px), std::pair(b.a, a.a),
                                            std::pair(b.b, a.b), std::pair(b.c, a.c), std::pair(b.weight, a.weight)})
          EXPECT_NEAR(got, expected, test::kMatchBodies * (1 << level)) << a.vertex;
      }
    }
  }
}

TEST(TextureMatcher, CoarseLevelsFindLargerMoves) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(2, 7);
    const Actor actor = plane_actor(texture);
    const Drawing drawing = draw(plane_camera(), texture, 7, 5, 1, 1);
    const Errors coarse = errors(actor, find(device, actor, drawing, 2), 7, 5);
    EXPECT_GE(coarse.u.size(), 0.7 * kInner);
    EXPECT_LT(quantile(coarse.u, 0.5), 1.0);
    EXPECT_LT(quantile(coarse.v, 0.5), 1.0);
    // It is too far for the finest.
    const Errors fine = errors(actor, find(device, actor, drawing, 0), 7, 5);
    EXPECT_LT(fine.u.size(), 0.5 * kInner);
  });
}

TEST(TextureMatcher, StripesAreCertainAcrossThemOnly) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    std::vector<double> stripes;
    for (int y = 0; y < kTextureSide; ++y)
      for (int x = 0; x < kTextureSide; ++x) stripes.push_back(128 + 80 * std::sin(2 * M_PI * y / 16.0));
    const Actor actor = plane_actor(stripes);
    const auto matches = find(device, actor, draw(plane_camera(), stripes, 2, 1.5, 1, 1), 0);
    EXPECT_LT(quantile(errors(actor, matches, 2, 1.5).v, 0.9), 0.3);
    size_t n = 0;
    for (const VertexMatch& match : matches) {
      if (!well_inside(match.vertex)) continue;
      EXPECT_LT(match.a * match.a, 0.05);
      EXPECT_GT(match.b * match.b + match.c * match.c, 0.9);
      ++n;
    }
    EXPECT_GE(n, 0.95 * kInner);
  });
}

TEST(TextureMatcher, AnotherTextureIsNotMatched) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Actor actor = plane_actor(noise(3));
    const auto matches = find(device, actor, draw(plane_camera(), noise(4), 0, 0, 1, 1), 0);
    EXPECT_LT(errors(actor, matches, 0, 0).u.size(), 0.25 * kInner);
  });
}

TEST(TextureMatcher, WeightsAddUpToTheArea) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(5);
    const Actor actor = plane_actor(texture);
    double sum = 0;
    size_t n = 0;
    for (const VertexMatch& match : find(device, actor, draw(plane_camera(), texture, 0, 0, 1, 1), 0)) {
      if (!well_inside(match.vertex)) continue;
      sum += match.weight;
      ++n;
    }
    // 240 px / 20 cells: 144 px around each vertex, times how far the correlation, near 1, is above the least one.
    EXPECT_NEAR(sum / double(n), 144 / MatchOptions{}.weight_area_px, 0.1 * 144 / MatchOptions{}.weight_area_px);
  });
}

TEST(TextureMatcher, NothingToMatchIsNothingFound) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Actor plain = plane_actor(noise(6));
    const Drawing drawing = draw(plane_camera(), noise(6), 0, 0, 1, 1);
    plain.texture = {};
    EXPECT_TRUE(find(device, plain, drawing, 0).empty());
    Drawing empty = drawing;
    empty.silhouette.box = {};
    EXPECT_TRUE(find(device, plane_actor(noise(6)), empty, 0).empty());
  });
}

// A palette: halved until it fits, nothing is left of its height.
TEST(TextureMatcher, AStripOfColoursIsNoTexture) {
  Actor palette = plane_actor(noise(1));
  palette.texture = {4096, 8, std::vector<uint8_t>(3 * 4096 * 8, 128)};
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    EXPECT_FALSE(TextureMatcher(device, palette, plane_camera(), MatchOptions{}).usable());
  });
}

TEST(TextureMatcher, RefusesWhatDoesNotFit) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Actor actor = plane_actor(noise(7));
    const Drawing drawing = draw(plane_camera(), noise(7), 0, 0, 1, 1);
    EXPECT_THROW(find(device, actor, drawing, LC_MATCH_LEVELS + 1), LogicError);
    EXPECT_THROW(find(device, actor, drawing, -1), LogicError);
    Drawing beyond = drawing;
    beyond.silhouette.box.x1 = plane_camera().width + 1;
    EXPECT_THROW(find(device, actor, beyond, 0), LogicError);
    TextureMatcher matcher(device, actor, plane_camera(), MatchOptions{});
    EXPECT_THROW(matcher.set_picture(DeviceFrame(device, 64, 64), {1, 1, 9, 9}), LogicError);
    MatchOptions bad;
    bad.min_correlation = 1.5f;
    EXPECT_THROW(TextureMatcher(device, actor, plane_camera(), bad), ConfigError);
    for (const float blur : {-0.1f, 1.1f, NAN}) {
      MatchOptions blurred;
      blurred.blur = blur;
      EXPECT_THROW(TextureMatcher(device, actor, plane_camera(), blurred), ConfigError);
    }
  });
}

TEST(TextureMatcher, SelfTestPassesOnEveryDevice) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const auto& result : match_self_test(device)) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
  });
}

}  // namespace
}  // namespace livecap
