#include "raster/overlay.h"

#include <gtest/gtest.h>

#include "livecap/error.h"
#include "scenes.h"

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

TEST(Overlay, SideBySideKeepsTheInputAtTheLeft) {
  const Actor actor = square_actor();
  const ImageRgb background{40, 30, std::vector<uint8_t>(3 * 40 * 30, 100)};
  OverlayOptions options;
  options.side_by_side = true;
  const ImageRgb out = render_overlay(actor, actor.mesh.positions, square_camera(), background, options);
  ASSERT_EQ(out.width, 80);
  EXPECT_EQ(out.pixels[3 * (15 * 80 + 15)], 100);
  EXPECT_NE(out.pixels[3 * (15 * 80 + 40 + 15)], 100);
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

}  // namespace
}  // namespace livecap
