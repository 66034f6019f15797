#include "picture/overlay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "livecap/error.h"
#include "raster/scenes.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// One square of 20x20 px with a texture of two colours, left and right.
Actor square_actor() {
  Actor actor;
  test::add_plane(actor.mesh, -100, -100, 200, 1000, 1);  // vertices: (0,0) (1,0) (0,1) (1,1)
  actor.colors.assign(3 * actor.n_vertices(), 0.5f);
  actor.render.template_vertex = {0, 1, 2, 3};
  actor.render.uvs = {0, 0, 1, 0, 0, 1, 1, 1};
  actor.render.triangles = actor.mesh.triangles;
  actor.texture = {2, 1, {250, 0, 0, 0, 0, 250}};
  return actor;
}

Camera square_camera() {
  Camera camera;
  camera.width = 40;
  camera.height = 30;
  camera.fx = camera.fy = 100;
  camera.cx = 20.5;
  camera.cy = 15.5;
  return camera;
}

TEST(Overlay, DrawsTheTextureWhereTheSquareIs) {
  const Actor actor = square_actor();
  const Camera camera = square_camera();
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 100)};
  OverlayOptions options;
  options.alpha = 0.5f;
  options.shading = false;
  const ImageRgb out = render_overlay(actor, actor.mesh.positions, camera, background, options);
  ASSERT_EQ(out.width, 40);
  int changed = 0;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const uint8_t* p = &out.pixels[3 * (y * 40 + x)];
      const bool inside = x > 10 && x < 31 && y > 5 && y < 26;  // 10.5 .. 30.5, 5.5 .. 25.5
      changed += p[1] != 100;
      if (!inside) EXPECT_EQ(p[0], 100) << x << "," << y;
      if (inside && x < 15) EXPECT_EQ(p[0], 175) << x << "," << y;  // halfway to pure red
      if (inside && x < 15) EXPECT_EQ(p[2], 50) << x << "," << y;
      if (inside && x > 26) EXPECT_EQ(p[2], 175) << x << "," << y;
    }
  }
  EXPECT_EQ(changed, 400);
  // Halfway across the colours mix evenly: between pixels 20 and 21.
  const uint8_t* middle = &out.pixels[3 * (15 * 40 + 20)];
  EXPECT_NEAR(middle[0] + middle[3], middle[2] + middle[5], 2);
}

TEST(Overlay, HiddenAndNearTrianglesAndBadInput) {
  Actor actor = square_actor();
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 100)};
  std::vector<float> behind = actor.mesh.positions;
  for (size_t i = 2; i < behind.size(); i += 3) behind[i] = -1000;
  EXPECT_EQ(render_overlay(actor, behind, square_camera(), background).pixels, background.pixels);
  EXPECT_THROW(render_overlay(actor, std::vector<float>(3), square_camera(), background), LogicError);
  EXPECT_THROW(render_overlay(actor, actor.mesh.positions, square_camera(), ImageRgb{1, 1, {0, 0, 0}}), ConfigError);
  OverlayOptions options;
  options.alpha = 2;
  EXPECT_THROW(render_overlay(actor, actor.mesh.positions, square_camera(), background, options), ConfigError);
}

TEST(Overlay, ColoursOfVerticesInsteadOfTheTexture) {
  Actor actor = square_actor();
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 100)};
  const std::vector<float> colors = {1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1};  // red at the left, blue at the right
  OverlayOptions options;
  options.alpha = 1;
  options.shading = false;
  options.colors = colors;
  const ImageRgb out = render_overlay(actor, actor.mesh.positions, square_camera(), background, options);
  for (int x = 11; x <= 30; ++x) {
    const double blue = 255 * (x - 10.5) / 20;  // the square spans 10.5 .. 30.5
    EXPECT_NEAR(out.pixels[3 * (15 * 40 + x)], 255 - blue, test::kByteRounding) << x;
    EXPECT_NEAR(out.pixels[3 * (15 * 40 + x) + 2], blue, test::kByteRounding) << x;
  }
  const std::vector<float> few(3);
  options.colors = few;
  EXPECT_THROW(render_overlay(actor, actor.mesh.positions, square_camera(), background, options), LogicError);
}

TEST(Overlay, TheNearSurfaceIsInFrontWhicheverIsDrawnFirst) {
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 100)};
  for (const bool near_first : {true, false}) {
    Actor actor;
    for (const bool near : {near_first, !near_first})
      near ? test::add_plane(actor.mesh, -25, -25, 50, 500, 1) : test::add_plane(actor.mesh, -100, -100, 200, 1000, 1);
    actor.render.triangles = actor.mesh.triangles;
    for (int i = 0; i < actor.n_vertices(); ++i) {
      actor.render.template_vertex.push_back(i);
      const bool near = (i < 4) == near_first;
      actor.colors.insert(actor.colors.end(), {near ? 1.0f : 0.0f, 0, near ? 0.0f : 1.0f});
    }
    const ImageRgb out = render_overlay(actor, actor.mesh.positions, square_camera(), background, {1, true, false});
    const auto pixel = [&](int x, int y) { return &out.pixels[3 * (y * 40 + x)]; };
    EXPECT_EQ(pixel(20, 15)[0], 255);  // the near one: 15.5 .. 25.5
    EXPECT_EQ(pixel(20, 15)[2], 0);
    EXPECT_EQ(pixel(12, 15)[0], 0);  // the far one: 10.5 .. 30.5
    EXPECT_EQ(pixel(12, 15)[2], 255);
  }
}

TEST(Overlay, ChecksLieOnTheSurfaceAtRest) {
  Actor actor = square_actor();  // 200 mm = 20 px
  const std::vector<float> placed = actor.mesh.positions;
  for (size_t i = 2; i < placed.size(); i += 3) actor.mesh.positions[i] = 25;  // in the middle of a check
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 100)};
  OverlayOptions options;
  options.alpha = 1;
  options.shading = false;
  options.checks_mm = 50;  // 5 px
  std::vector<float> moved = placed;
  for (size_t i = 0; i < moved.size(); i += 3) moved[i] += 30;  // 3 px to the right: the checks come along
  const ImageRgb at_rest = render_overlay(actor, placed, square_camera(), background, options);
  const ImageRgb later = render_overlay(actor, moved, square_camera(), background, options);
  const auto light = [](const ImageRgb& image, int x, int y) { return image.pixels[3 * (y * 40 + x)] > 128; };
  for (int i = 0; i + 1 < 4; ++i) {
    const int x = 13 + 5 * i;  // the middle of a check
    EXPECT_NE(light(at_rest, x, 8), light(at_rest, x + 5, 8));
    EXPECT_NE(light(at_rest, x, 8), light(at_rest, x, 13));
    EXPECT_EQ(light(at_rest, x, 8), light(later, x + 3, 8));
  }
}

TEST(Overlay, TheKeyLightComesFromTheUpperLeft) {
  Actor actor;
  actor.mesh = test::sphere({0, 0, 1000}, 120, 20, 30);
  actor.render.triangles = actor.mesh.triangles;
  for (int i = 0; i < actor.n_vertices(); ++i) actor.render.template_vertex.push_back(i);
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 0)};
  OverlayOptions options;
  options.texture = false;
  const auto value = [&](int dx, int dy) {  // px from the sphere's middle
    const ImageRgb out = render_overlay(actor, actor.mesh.positions, square_camera(), background, options);
    return static_cast<int>(out.pixels[3 * ((15 + dy) * 40 + 20 + dx)]);
  };
  EXPECT_NEAR(value(-6, -6), value(7, 7), test::kHeadlightBytes);  // the sphere's middle is between two pixels
  options.key_light = true;
  EXPECT_GT(value(-6, -6), value(7, 7) + 60);
  EXPECT_GT(value(-6, -6), value(7, -6) + 20);
  EXPECT_GT(value(-6, -6), value(-6, 7) + 20);
  std::reverse(actor.mesh.triangles.begin(), actor.mesh.triangles.end());  // inside out
  EXPECT_GT(value(-6, -6), value(7, 7) + 60);
}

TEST(Overlay, EdgesOfTrianglesAreDark) {
  const Actor actor = square_actor();
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 100)};
  OverlayOptions options;
  options.texture = false;
  options.shading = false;
  options.alpha = 1;
  const ImageRgb plain = render_overlay(actor, actor.mesh.positions, square_camera(), background, options);
  options.wire_px = 2;
  const ImageRgb wire = render_overlay(actor, actor.mesh.positions, square_camera(), background, options);
  // The square's outline and the diagonal that both its triangles share.
  for (int y = 6; y <= 25; ++y) {
    for (int x = 11; x <= 30; ++x) {
      const double u = x - 10.5, v = y - 5.5;  // from the square's corner, px
      const double diagonal = std::abs(u + v - 20) / std::sqrt(2.0);
      const double away = std::min({u, v, 20 - u, 20 - v, diagonal});
      const size_t i = 3 * (y * 40 + x);
      if (std::abs(away - 1) < test::kLinePx) continue;
      EXPECT_EQ(wire.pixels[i] < plain.pixels[i], away < 1) << x << "," << y;
    }
  }
}

}  // namespace
}  // namespace livecap
