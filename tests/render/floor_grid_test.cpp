#include "render/floor_grid.h"

#include <gtest/gtest.h>

namespace livecap::render {
namespace {

using Eigen::Vector3d;

// A level camera 1 m above the floor; what is looked grey_at is 3 m in front of it, 0.9 m above the floor.
const Floor kFloor{-Vector3d::UnitY(), 1000};
const Vector3d kPlace(0, 100, 3000);

// Straight down onto the place from 4 m, the capturing camera's side below: 10 mm a pixel.
Viewpoint from_above() {
  Camera camera = camera_from_fov(301, 301, 40);
  camera.fx = camera.fy = 490;  // the floor is 4.9 m away
  return viewpoint_about(camera, {kPlace, kFloor.up}, {0, 90}, 4000);
}

ImageRgb white() {
  return {301, 301, std::vector<uint8_t>(3 * 301 * 301, 255)};
}

uint8_t grey_at(const ImageRgb& image, int x, int y) {
  return image.pixels[3 * (size_t(y) * image.width + x)];
}

TEST(FloorGrid, LinesEveryHalfMetreFromThePlaceOn) {
  ImageRgb canvas = white();
  FloorGrid(kFloor, kPlace).draw(from_above(), {}, {}, canvas);
  const uint8_t floor = grey_at(canvas, 175, 175);
  EXPECT_LT(floor, 255);
  for (int x = 110; x <= 190; ++x) {  // 150 is the place: lines grey_at 100, 150, 200
    EXPECT_EQ(grey_at(canvas, x, 120) < floor, x == 150) << x;
    EXPECT_EQ(grey_at(canvas, 120, x) < floor, x == 150) << x;
  }
  EXPECT_LT(grey_at(canvas, 100, 120), floor);
  EXPECT_LT(grey_at(canvas, 120, 200), floor);
}

TEST(FloorGrid, TheShadowLiesBelowTheBodyAndIsDarkerWhereThatIsNear) {
  // Two squares of 400 mm: half a metre to the right of the place just above the floor, to the left 700 mm up.
  std::vector<float> positions;
  for (const auto& [x, up] : {std::pair{250.0f, 10.0f}, {-250.0f, 700.0f}}) {
    for (const auto& [dx, dz] : {std::pair{-200, -200}, {200, -200}, {200, 200}, {-200, 200}})
      positions.insert(positions.end(), {x + dx, 1000 - up, 3000.0f + dz});
  }
  const std::vector<int32_t> triangles = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  const FloorGrid grid(kFloor, kPlace);
  ImageRgb empty = white(), canvas = white();
  grid.draw(from_above(), {}, {}, empty);
  grid.draw(from_above(), positions, triangles, canvas);
  const auto darkened = [&](int x, int y) { return grey_at(empty, x, y) - grey_at(canvas, x, y); };
  EXPECT_GT(darkened(175, 155), 80);  // below the near one
  EXPECT_GT(darkened(125, 155), 5);   // below the far one
  EXPECT_LT(darkened(125, 155), darkened(175, 155) / 3);
  EXPECT_EQ(darkened(175, 215), 0);  // beside them
}

TEST(FloorGrid, NothingAboveTheHorizonOrFromBelow) {
  const FloorGrid grid(kFloor, kPlace);
  const Camera camera = camera_from_fov(301, 301, 60);
  ImageRgb canvas = white();
  grid.draw(viewpoint_about(camera, {kPlace, kFloor.up}, {20, 0}, 3000), {}, {}, canvas);
  for (int x = 0; x < 301; ++x) EXPECT_EQ(grey_at(canvas, x, 149), 255);
  EXPECT_LT(grey_at(canvas, 150, 260), 255);
  canvas = white();
  grid.draw(viewpoint_about(camera_from_fov(301, 301, 150), {kPlace, kFloor.up}, {20, -60}, 1200), {}, {}, canvas);
  EXPECT_EQ(canvas.pixels, white().pixels);
}

}  // namespace
}  // namespace livecap::render
