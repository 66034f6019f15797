// Pictures of meshes: which colour ends up where.
#include "eval/mesh_picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "livecap/error.h"

namespace livecap {
namespace {

Camera small_camera() {
  Camera camera;
  camera.width = 20;
  camera.height = 16;
  camera.fx = camera.fy = 100;
  camera.cx = 9;
  camera.cy = 7;
  return camera;
}

// A square facing the camera as two triangles.
std::vector<float> square(float size, float z) {
  return {-size, -size, z, size, -size, z, size, size, z, -size, size, z};
}
const std::vector<int32_t> kSquare = {0, 1, 2, 0, 2, 3};

const uint8_t* pixel(const ImageRgb& image, int x, int y) {
  return &image.pixels[3 * (size_t(y) * image.width + x)];
}

TEST(MeshPicture, ColoursAndOrderOfDepth) {
  const Camera camera = small_camera();
  ImageRgb canvas{20, 16, std::vector<uint8_t>(3 * 20 * 16, 255)};
  const std::vector<Rgb> red(4, {200, 0, 0}), blue(4, {0, 0, 200});
  paint_mesh(square(5, 500), kSquare, red, camera, canvas);     // columns 8..10
  paint_mesh(square(25, 1000), kSquare, blue, camera, canvas);  // a canvas knows no depth: 7..11, over the red one
  EXPECT_EQ(pixel(canvas, 9, 7)[2], 200);
  EXPECT_EQ(pixel(canvas, 7, 5)[2], 200);
  EXPECT_EQ(pixel(canvas, 6, 5)[2], 255);

  // Both in one mesh: the near one is in front, whichever is drawn first.
  std::vector<float> both = square(5, 500);
  const std::vector<float> far = square(25, 1000);
  both.insert(both.end(), far.begin(), far.end());
  std::vector<Rgb> colors = red;
  colors.insert(colors.end(), blue.begin(), blue.end());
  for (const std::vector<int32_t>& triangles : {std::vector<int32_t>{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7},
                                                std::vector<int32_t>{4, 5, 6, 4, 6, 7, 0, 1, 2, 0, 2, 3}}) {
    canvas.pixels.assign(canvas.pixels.size(), 255);
    paint_mesh(both, triangles, colors, camera, canvas);
    EXPECT_GT(pixel(canvas, 9, 7)[0], 190);  // nearly facing: hardly darkened
    EXPECT_EQ(pixel(canvas, 9, 7)[2], 0);
    EXPECT_GT(pixel(canvas, 7, 5)[2], 190);
  }
  ImageRgb wrong{5, 5, std::vector<uint8_t>(75)};
  EXPECT_THROW(paint_mesh(both, kSquare, colors, camera, wrong), LogicError);
  EXPECT_THROW(paint_mesh(both, kSquare, red, camera, canvas), LogicError);
}

TEST(MeshPicture, TurnaroundShowsTheFrontFirstAndTheSubjectsLeftOnTheRight) {
  // A box of 200 x 400 x 100 mm; front vertices at +X green, at -X blue; the back ones red.
  std::vector<float> positions;
  std::vector<Rgb> colors;
  for (float z : {50.0f, -50.0f}) {
    for (float y : {0.0f, 400.0f}) {
      for (float x : {-100.0f, 100.0f}) {
        positions.insert(positions.end(), {x, y, z});
        colors.push_back(z < 0 ? Rgb{255, 0, 0} : x > 0 ? Rgb{0, 255, 0} : Rgb{0, 0, 255});
      }
    }
  }
  const std::vector<int32_t> triangles = {0, 1, 3, 0, 3, 2, 5, 4, 6, 5, 6, 7, 1, 5, 7, 1, 7, 3,
                                          4, 0, 2, 4, 2, 6, 2, 3, 7, 2, 7, 6, 4, 5, 1, 4, 1, 0};
  const ImageRgb image = paint_turnaround(positions, triangles, colors, 100);
  EXPECT_EQ(image.height, 100);
  // 94 px for 400 mm: figures 47, 23.5, 47, 23.5 px wide, 3 px of margin on each side of each.
  ASSERT_NEAR(image.width, 2 * 47 + 2 * 23.5 + 8 * 3, 1);
  const auto strongest = [&](int x) {
    const uint8_t* p = pixel(image, x, 50);
    return p[0] == 255 && p[1] == 255 ? -1 : static_cast<int>(std::max_element(p, p + 3) - p);
  };
  EXPECT_EQ(strongest(0), -1);   // margin
  EXPECT_EQ(strongest(6), 2);    // front, the subject's right: blue
  EXPECT_EQ(strongest(46), 1);   // front, the subject's left: green
  EXPECT_EQ(strongest(59), 1);   // from the left the front is on the left: green
  EXPECT_EQ(strongest(76), 0);   // and the back on the right
  EXPECT_EQ(strongest(105), 0);  // the back
}

TEST(MeshPicture, ScalesEndWhereTheySay) {
  EXPECT_EQ(heat_color(-1), heat_color(0));
  EXPECT_EQ(heat_color(2), heat_color(1));
  EXPECT_GT(heat_color(0)[2], heat_color(1)[2]);
  EXPECT_GT(diverging_color(-1)[0], diverging_color(-1)[2]);  // red: worse
  EXPECT_GT(diverging_color(1)[2], diverging_color(1)[0]);    // blue: better
  EXPECT_EQ(diverging_color(0)[0], diverging_color(0)[1]);    // grey
}

}  // namespace
}  // namespace livecap
