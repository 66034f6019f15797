// The actor drawn lit as the person in the picture is, and how that light is seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "match/plane_scene.h"
#include "match/texture_matcher.h"
#include "ocl/kernel.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using namespace test;  // plane_scene.h

constexpr int kLitRow = kPlaneCells + 1;
constexpr uint8_t kPlainGrey = 128;
const Light kSideLight = {0.6f, 0.5f, 0.4f, -0.1f, 0, 0, 0, 0, 0};

double shade(const Light& light, const Eigen::Vector3d& n) {
  const double x = n.x(), y = n.y(), z = n.z();
  const double harmonics[] = {1, x, y, z, x * y, y * z, x * z, x * x - y * y, 3 * z * z - 1};
  double sum = 0;
  for (int k = 0; k < 9; ++k) sum += double(light[k]) * harmonics[k];
  return std::max(sum, 0.05);
}

std::vector<Eigen::Vector3d> bumpy(int seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  std::vector<Eigen::Vector3d> normals;
  for (int i = 0; i < kLitRow * kLitRow; ++i)
    normals.push_back(Eigen::Vector3d(uniform(rng), uniform(rng), -1).normalized());
  return normals;
}

// How a colour 0..255 looks in a light: as bright as that, but for the 0.04 (of linear light) that surfaces mirror
// whatever their colour.
double in_light(double value, double shade) {
  const double linear = value * value / (255.0 * 255.0);
  return value * (linear * shade + 0.04) / (linear + 0.04);
}

// Of a plane with these normals: linear between the corners of its triangles.
double shade_at(double u, double v, const std::vector<double>& shades) {
  const double x = std::clamp(u * kPlaneCells, 0.0, kPlaneCells - 1e-9);
  const double y = std::clamp(v * kPlaneCells, 0.0, kPlaneCells - 1e-9);
  const int i = int(x), j = int(y);
  const double fx = x - i, fy = y - j;
  const double *top = &shades[size_t(j) * kLitRow + i], *bottom = top + kLitRow;
  if (fx + fy < 1) return top[0] + fx * (top[1] - top[0]) + fy * (bottom[0] - top[0]);
  return bottom[1] + (1 - fx) * (bottom[0] - bottom[1]) + (1 - fy) * (top[1] - bottom[1]);
}

// A grey plane in that light, moved by (dx, dy) px.
Drawing draw_lit(const Camera& camera, const std::vector<double>& shades, double dx, double dy) {
  Drawing d = draw(camera, std::vector<double>(size_t(kTextureSide) * kTextureSide, kPlainGrey), dx, dy, 1, 1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double u = ((x - dx - camera.cx) / camera.fx * kPlaneDepth / kPlaneHalf + 1) / 2;
      const double v = ((y - dy - camera.cy) / camera.fy * kPlaneDepth / kPlaneHalf + 1) / 2;
      if (!(u > 0 && u < 1 && v > 0 && v < 1)) continue;
      const auto grey = uint8_t(std::lround(std::clamp(in_light(kPlainGrey, shade_at(u, v, shades)), 0.0, 255.0)));
      std::fill_n(&d.picture.pixels[3 * (size_t(y) * camera.width + x)], 3, grey);
    }
  }
  return d;
}

// A matcher of the plane and all that it looks at.
struct Matching {
  Camera camera = plane_camera();
  Actor actor;
  DeviceFrame frame;
  DepthRasterizer raster;
  ocl::Buffer<float> positions, normals, share;
  ocl::Buffer<int32_t> visible;
  TextureMatcher matcher;

  Matching(ocl::DeviceContext& device, const Actor& of, const Drawing& drawing, const std::vector<Eigen::Vector3d>& n)
      : actor(of),
        frame(device, camera.width, camera.height),
        raster(device, actor.mesh, camera.width, camera.height),
        positions(device, actor.mesh.positions),
        normals(device, floats(n)),
        share(device, std::vector<float>(actor.n_vertices(), 1.0f)),
        visible(device, std::vector<int32_t>(actor.n_vertices(), 1)),
        matcher(device, actor, camera, MatchOptions{}) {
    frame.upload(drawing.silhouette, drawing.picture);
    raster.render(positions, camera);
    matcher.set_picture(frame, drawing.silhouette.box);
  }
  static std::vector<float> floats(const std::vector<Eigen::Vector3d>& points) {
    std::vector<float> values;
    for (const Eigen::Vector3d& p : points) values.insert(values.end(), {float(p.x()), float(p.y()), float(p.z())});
    return values;
  }
  std::vector<VertexMatch> match(int level = 0) {
    matcher.match(raster, positions, normals, visible, share, level);
    return matcher.read().found;
  }
  std::vector<LightSample> sample() { return matcher.sample_light(frame, raster, positions, normals, visible); }
};

const std::vector<Eigen::Vector3d> kTowardsCamera(size_t(kLitRow) * kLitRow, -Eigen::Vector3d::UnitZ());

TEST(Light, ShadesEveryVertexByItsNormal) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<Eigen::Vector3d> normals = bumpy(1);
    const Light light = {0.4f, 0.5f, -0.3f, 0.2f, -0.6f, 0.7f, 0.3f, -0.2f, 0.1f};
    ocl::Buffer<float> shades(device, normals.size());
    ocl::Kernel(device, kMatchProgram, "light_vertices")
        .launch(normals.size(), 64, int(normals.size()), light, ocl::Buffer<float>(device, Matching::floats(normals)),
                shades);
    const std::vector<float> found = shades.read_all();
    int darkest = 0;
    for (size_t i = 0; i < normals.size(); ++i) {
      EXPECT_NEAR(found[i], shade(light, normals[i]), test::kFloatRelative) << i;
      darkest += found[i] == 0.05f;
    }
    EXPECT_GT(darkest, 0);
    EXPECT_LT(darkest, int(normals.size()) / 2);
  });
}

// What has one colour is matched by how it is lit, where that is known.
TEST(Light, OnAnActorWithoutTextureIsMatched) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const double dx = 1.3, dy = -0.8;
    const std::vector<Eigen::Vector3d> normals = bumpy(2);
    std::vector<double> shades;
    for (const Eigen::Vector3d& n : normals) shades.push_back(shade(kSideLight, n));
    Matching m(device, plane_actor(std::vector<double>(size_t(kTextureSide) * kTextureSide, kPlainGrey)),
               draw_lit(plane_camera(), shades, dx, dy), normals);
    EXPECT_TRUE(m.match().empty()) << "unlit it has no contrast";
    m.matcher.set_light(kSideLight);
    std::vector<double> errors_px;
    for (const VertexMatch& match : m.match()) {
      const int i = match.vertex % kLitRow, j = match.vertex / kLitRow;
      if (std::min(i, j) < 4 || std::max(i, j) > kPlaneCells - 4) continue;
      const float* p = &m.actor.mesh.positions[3 * size_t(match.vertex)];
      errors_px.push_back(std::hypot(match.u_px - (m.camera.fx * p[0] / p[2] + m.camera.cx + dx),
                                     match.v_px - (m.camera.fy * p[1] / p[2] + m.camera.cy + dy)));
    }
    ASSERT_GE(errors_px.size(), size_t(0.95 * (kPlaneCells - 7) * (kPlaneCells - 7)));
    std::sort(errors_px.begin(), errors_px.end());
    EXPECT_LT(errors_px[errors_px.size() / 2], 0.1);
    EXPECT_LT(errors_px[errors_px.size() * 9 / 10], 0.25);
  });
}

// Whatever light the actor was drawn in.
TEST(Light, IsSeenByWhatColoursAre) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(3, 6);
    const double bright = 0.62;
    std::vector<double> lit;
    for (const double value : texture) lit.push_back(in_light(value, bright));
    Matching m(device, plane_actor(texture), draw(plane_camera(), lit, 0, 0, 1, 1), kTowardsCamera);
    for (const Light& drawn_in : {Light{1}, Light{0.8f, 0, 0, 0.3f}}) {
      m.matcher.set_light(drawn_in);
      m.match();
      const std::vector<LightSample> samples = m.sample();
      EXPECT_GT(samples.size(), size_t(0.8 * kLitRow * kLitRow));
      std::vector<double> off;
      for (const LightSample& s : samples) {
        off.push_back(std::abs(s.brightness - bright));
        EXPECT_EQ(s.normal, Eigen::Vector3f(0, 0, -1));
        EXPECT_GT(s.weight, 0);
      }
      std::sort(off.begin(), off.end());  // the picture is drawn with the nearest texel
      EXPECT_LT(off[off.size() / 2], 0.01);
      EXPECT_LT(off[off.size() * 9 / 10], 0.04);
    }
    m.match(1);
    EXPECT_TRUE(m.sample().empty()) << "of coarse levels nothing is told";
  });
}

// White cloth shows nearly all of a shadow, black shoes a fifth of it.
TEST(Light, HardlyShowsOnWhatIsBlack) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const auto left_of_a_shadow = [&](double value) {
      const std::vector<double> texture(size_t(kTextureSide) * kTextureSide, value);
      Matching m(device, plane_actor(texture), draw(plane_camera(), texture, 0, 0, 1, 1), kTowardsCamera);
      m.matcher.set_light({0.5f});
      m.match();
      double brightness = 0, weights = 0;
      for (const LightSample& s : m.sample()) {
        brightness += double(s.weight) * s.brightness;
        weights += s.weight;
      }
      EXPECT_NEAR(brightness / weights, 1, 0.02) << "the picture shows the colours as they are";
      return weights;
    };
    // By the square of what the light changes of a colour: 0.95 of 230, 0.18 of 24.
    const double white = left_of_a_shadow(230), black = left_of_a_shadow(24);
    EXPECT_NEAR(std::sqrt(black / white), 0.18 * 24 / (0.95 * 230), 0.002);
  });
}

// Patches across the silhouette's edge, brighter or darker than what is around them.
TEST(Light, NoPatchIsMoreLikeTheOtherThanTheSame) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(5, 5);
    Drawing drawing = draw(plane_camera(), texture, 0.4, -0.3, 1, 1);
    ImageGray mask{plane_camera().width, plane_camera().height, {}};
    for (const float distance : drawing.silhouette.signed_distance) mask.pixels.push_back(distance < -11 ? 255 : 0);
    drawing.silhouette = make_silhouette(mask);
    Matching m(device, plane_actor(texture), drawing, kTowardsCamera);
    EXPECT_GT(m.match().size(), size_t(kLitRow * kLitRow / 2));
    const std::vector<float> all = m.matcher.matches().read_all();
    for (size_t i = 0; i < all.size(); i += LC_MATCH) {
      EXPECT_LE(all[i + LC_MATCH_CORRELATION], 1) << i / LC_MATCH;
      EXPECT_LE(all[i + LC_MATCH_WEIGHT_PX], all[i + LC_MATCH_SEEN_PX]) << i / LC_MATCH;
    }
  });
}

TEST(Light, IsSeenWhereThePersonIs) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const std::vector<double> texture = noise(4, 6);
    Drawing drawing = draw(plane_camera(), texture, 0, 0, 1, 1);
    const Camera camera = plane_camera();
    const int cut = camera.width / 2;
    ImageGray mask{camera.width, camera.height, {}};
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) mask.pixels.push_back(x < cut ? 255 : 0);
    drawing.silhouette = make_silhouette(mask);
    Matching m(device, plane_actor(texture), drawing, kTowardsCamera);
    m.match();
    const size_t n = m.sample().size();
    EXPECT_GT(n, size_t(0.3 * kLitRow * kLitRow));
    EXPECT_LT(n, size_t(0.5 * kLitRow * kLitRow));
  });
}

}  // namespace
}  // namespace livecap
