// Colours of a ball of two materials that one picture shows from the front.
#include "texture/texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/srgb.h"
#include "meshing/surface_parts.h"
#include "support/test_device.h"
#include "support/tolerances.h"
#include "texture/surface_views.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

constexpr int kSize = 240, kTexels = 512;
constexpr uint8_t kRed[3] = {200, 40, 40}, kBlue[3] = {40, 40, 200};

// Looks along -z from 1 m in front of the origin.
View view_from_front() {
  View view;
  view.camera = camera_from_fov(kSize, kSize, 20);
  view.camera_from_world.linear() = Vector3d(1, -1, -1).asDiagonal();
  view.camera_from_world.translation() = Vector3d(0, 0, 1000);
  view.image = {kSize, kSize, std::vector<uint8_t>(3 * kSize * kSize)};
  view.labels = {kSize, kSize, std::vector<uint8_t>(kSize * kSize)};
  return view;
}

// Of a ball that nothing hides.
ViewCoverage cover_ball(const meshing::Surface& ball, const View& view) {
  const size_t n = ball.vertices.size();
  const std::vector<Vector3d> normals = meshing::vertex_normals(ball);
  ViewCoverage coverage{std::vector<float>(n, 0), std::vector<Eigen::Vector2f>(n)};
  for (size_t i = 0; i < n; ++i) {
    const Vector3d to_camera = (view.center() - ball.vertices[i]).normalized();
    coverage.facing[i] = static_cast<float>(std::max(0.0, normals[i].dot(to_camera)));
    Eigen::Vector2d pixel;
    EXPECT_TRUE(view.project(ball.vertices[i], pixel));
    coverage.pixels[i] = pixel.cast<float>();
  }
  return coverage;
}

// In the middle of a triangle.
const uint8_t* middle_texel(const ImageRgb& image, const meshing::Atlas& atlas, size_t triangle) {
  const Eigen::Vector3i t = atlas.triangles[triangle];
  const Eigen::Vector2d uv = (atlas.uvs[t[0]] + atlas.uvs[t[1]] + atlas.uvs[t[2]]) / 3;
  const int x = static_cast<int>(uv.x() * kTexels), y = static_cast<int>(uv.y() * kTexels);
  return &image.pixels[3 * (static_cast<size_t>(y) * kTexels + x)];
}

TEST(Texture, HasTheColourOfItsMaterialWhereNothingIsSeen) {
  constexpr double kRadius = 100;
  const meshing::Surface ball = meshing::extract_surface([](const Vector3d& p) { return p.norm() - kRadius; },
                                                         {-130, -130, -130}, {130, 130, 130}, 20);
  const size_t n = ball.vertices.size();
  View view = view_from_front();
  // The picture's border between the colours is 4 px beside that of the materials, as where a surface is not exact.
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const size_t pixel = static_cast<size_t>(y) * kSize + x;
      view.labels.pixels[pixel] = x < kSize / 2 + 4 ? 1 : 2;
      std::copy_n(x < kSize / 2 + 4 ? kRed : kBlue, 3, &view.image.pixels[3 * pixel]);
    }
  const ViewCoverage coverage = cover_ball(ball, view);
  std::vector<uint8_t> labels;
  for (const Vector3d& vertex : ball.vertices) labels.push_back(vertex.x() < 0 ? 1 : 2);
  const meshing::Atlas atlas = meshing::make_atlas(ball, std::vector<int>(ball.triangles.size(), 0), {1.0}, kTexels);
  const BlendedTexture texture = blend_texture(ball, atlas, kTexels, {view}, {coverage}, labels);
  int n_unseen = 0;
  for (size_t t = 0; t < ball.triangles.size(); ++t) {
    const Eigen::Vector3i corners = ball.triangles[t];
    const uint8_t label = labels[corners[0]];
    if (labels[corners[1]] != label || labels[corners[2]] != label) continue;
    if (texture.seen[corners[0]] || texture.seen[corners[1]] || texture.seen[corners[2]]) continue;
    ++n_unseen;
    const uint8_t* color = middle_texel(texture.image, atlas, t);
    const uint8_t* expected = label == 1 ? kRed : kBlue;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(color[c], expected[c], test::kSpreadLevels) << "at " << ball.vertices[corners[0]].transpose();
  }
  EXPECT_GT(n_unseen, static_cast<int>(ball.triangles.size()) / 3);
  // Four such pictures are believed, and not the label.
  const BlendedTexture many =
      blend_texture(ball, atlas, kTexels, std::vector<View>(4, view), std::vector<ViewCoverage>(4, coverage), labels);
  int n_of_one = 0, n_of_many = 0;
  for (size_t i = 0; i < n; ++i) n_of_one += texture.seen[i], n_of_many += many.seen[i];
  EXPECT_GT(n_of_many, n_of_one);
}

// A grey ball that turns before a camera, beside which a lamp stands: each picture is the same, brighter on the right.
TEST(Texture, HasNoLightOfALampThatStandsBesideTheCamera) {
  constexpr double kRadius = 100, kAlbedo = 0.3;
  const meshing::Surface ball = meshing::extract_surface([](const Vector3d& p) { return p.norm() - kRadius; },
                                                         {-130, -130, -130}, {130, 130, 130}, 20);
  const Vector3d lamp = Vector3d(1, -0.5, -1).normalized();  // in the camera's frame
  std::vector<View> views;
  std::vector<ViewCoverage> coverages;
  for (int k = 0; k < 4; ++k) {
    View view = view_from_front();
    view.labels = {};
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const Vector3d ray =
            Vector3d((x - view.camera.cx) / view.camera.fx, (y - view.camera.cy) / view.camera.fy, 1).normalized();
        const Vector3d center(0, 0, 1000);
        const double along = ray.dot(center), root = along * along - center.squaredNorm() + kRadius * kRadius;
        const Vector3d normal = ((along - std::sqrt(std::max(0.0, root))) * ray - center).normalized();
        const double seen = srgb_from_linear(kAlbedo * (0.4 + std::max(0.0, normal.dot(lamp))));
        std::fill_n(&view.image.pixels[3 * (static_cast<size_t>(y) * kSize + x)], 3,
                    static_cast<uint8_t>(std::lround(255 * seen)));
      }
    view.camera_from_world.rotate(Eigen::AngleAxisd(k * M_PI / 2, Vector3d::UnitY()));
    coverages.push_back(cover_ball(ball, view));
    views.push_back(view);
  }
  const meshing::Atlas atlas = meshing::make_atlas(ball, std::vector<int>(ball.triangles.size(), 0), {1.0}, kTexels);
  // Of the triangles that some view sees, or of those at the end of what any sees.
  const auto unevenness = [&](LightFrame frame, bool at_the_end = false) {
    const auto [image, seen] = blend_texture(ball, atlas, kTexels, views, coverages, {}, frame);
    double sum = 0, squares = 0;
    int n = 0;
    for (size_t t = 0; t < ball.triangles.size(); ++t) {
      const auto& corners = ball.triangles[t];
      const int n_seen = seen[corners[0]] + seen[corners[1]] + seen[corners[2]];
      if (at_the_end ? n_seen == 0 || n_seen == 3 : std::abs(ball.vertices[corners[0]].y()) > kRadius / 2) continue;
      const double light = std::log(*middle_texel(image, atlas, t));
      sum += light, squares += light * light, ++n;
    }
    return std::sqrt(squares / n - sum * sum / n / n);
  };
  const double left = unevenness(LightFrame::kCamera), wrong = unevenness(LightFrame::kPerson);
  std::printf("a lamp beside the camera: uneven by %.4f, taken for one beside the person %.4f\n", left, wrong);
  EXPECT_LT(left, test::kTurnedLampLeft);
  EXPECT_GT(wrong, test::kTurnedLampLeft);
  const double at_the_end = unevenness(LightFrame::kCamera, true);
  std::printf("where no view sees further: %.4f\n", at_the_end);
  EXPECT_LT(at_the_end, test::kTurnedLampLeft);
}

// A view just as flat as is too flat weighs nothing, and shows nothing where it is the only one.
TEST(Texture, TheFlattestViewIsNone) {
  const meshing::Surface ball = meshing::extract_surface([](const Vector3d& p) { return p.norm() - 100; },
                                                         {-130, -130, -130}, {130, 130, 130}, 20);
  const size_t n = ball.vertices.size();
  View view = view_from_front();
  view.labels = {};
  ViewCoverage coverage{std::vector<float>(n, 1), std::vector<Eigen::Vector2f>(n, {kSize / 2, kSize / 2})};
  for (size_t i = 0; i < n; ++i)
    if (ball.vertices[i].x() < 0) coverage.facing[i] = 0.25f;
  const meshing::Atlas atlas = meshing::make_atlas(ball, std::vector<int>(ball.triangles.size(), 0), {1.0}, kTexels);
  const BlendedTexture texture = blend_texture(ball, atlas, kTexels, {view}, {coverage}, {});
  for (size_t i = 0; i < n; ++i) EXPECT_EQ(texture.seen[i] != 0, ball.vertices[i].x() >= 0);
}

// A wall 500 mm behind a plate that hides its left half: what projects to within a pixel of the plate's edge does not
// count as visible, because its pixel may show the plate.
TEST(Texture, IsNotTakenFromThePixelsOfAnEdge) {
  const View view = view_from_front();
  Mesh mesh;
  const auto add_quad = [&](double x0, double x1, double z) {
    const int first = mesh.n_vertices();
    for (double x : {x0, x1})
      for (double y : {-60.0, 60.0}) {
        const float p[3] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
        mesh.positions.insert(mesh.positions.end(), p, p + 3);
      }
    for (int k : {0, 2, 1, 1, 2, 3}) mesh.triangles.push_back(first + k);
  };
  add_quad(-80, 0, 500);
  const double mm_per_px = 1000 / view.camera.fx;
  std::vector<double> beside_px;
  for (double px : {-6.0, -2.0, 0.6, 3.0, 6.0}) {
    beside_px.push_back(px);
    add_quad(px * mm_per_px, (px + 20) * mm_per_px, 0);
  }
  test::on_every_device([&](ocl::DeviceContext& device) {
    const ViewCoverage coverage = cover_surface(device, mesh, {view}).front();
    for (size_t k = 0; k < beside_px.size(); ++k) {
      const int vertex = static_cast<int>(4 + 4 * k);
      EXPECT_EQ(coverage.facing[vertex] > 0, beside_px[k] > 1.5) << beside_px[k] << " px beside the edge";
    }
  });
}

}  // namespace
}  // namespace livecap
