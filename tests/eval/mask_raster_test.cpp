// The judge's rasteriser against areas worked out by hand and against OpenCV's projection.
#include "eval/mask_raster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

namespace livecap {
namespace {

// Half the size of the specks whose centre stands for a projected point.
constexpr double kSpeckPx = 1;

Camera small_camera() {
  Camera camera;
  camera.width = 20;
  camera.height = 16;
  camera.fx = camera.fy = 100;
  camera.cx = 9;
  camera.cy = 7;
  return camera;
}

// A square of +-size mm at depth z as two triangles.
std::vector<float> square(float size, float z) {
  return {-size, -size, z, size, -size, z, size, size, z, -size, size, z};
}
const std::vector<int32_t> kSquare = {0, 1, 2, 0, 2, 3};

int count(const ImageGray& mask) {
  int n = 0;
  for (uint8_t value : mask.pixels) n += value == 255;
  return n;
}

TEST(MaskRaster, SquareCoversThePixelsWhoseCentresAreInside) {
  // +-25 mm at 1000 mm with 100 px: +-2.5 px around (9, 7), so columns 7..11 and rows 5..9.
  const ImageGray mask = render_silhouette(square(25, 1000), kSquare, small_camera());
  EXPECT_EQ(count(mask), 25);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 20; ++x) {
      EXPECT_EQ(mask.pixels[y * 20 + x], x >= 7 && x <= 11 && y >= 5 && y <= 9 ? 255 : 0) << x << "," << y;
    }
  }
}

TEST(MaskRaster, WindingDoesNotMatter) {
  const std::vector<int32_t> reversed = {0, 2, 1, 0, 3, 2};
  EXPECT_EQ(render_silhouette(square(25, 1000), reversed, small_camera()).pixels,
            render_silhouette(square(25, 1000), kSquare, small_camera()).pixels);
}

TEST(MaskRaster, ClipsAtThePictureAndFillsIt) {
  EXPECT_EQ(count(render_silhouette(square(1e6f, 1000), kSquare, small_camera())), 20 * 16);
}

TEST(MaskRaster, LeavesOutWhatIsBehindOrNotFinite) {
  EXPECT_EQ(count(render_silhouette(square(25, -1000), kSquare, small_camera())), 0);
  std::vector<float> broken = square(25, 1000);
  broken[0] = std::numeric_limits<float>::quiet_NaN();  // the first corner is in both triangles
  EXPECT_EQ(count(render_silhouette(broken, kSquare, small_camera())), 0);
}

TEST(MaskRaster, EmptyMeshGivesAnEmptyMask) {
  EXPECT_EQ(count(render_silhouette({}, {}, small_camera())), 0);
}

TEST(MaskRaster, DistortionAgreesWithOpenCv) {
  Camera camera = small_camera();
  camera.width = camera.height = 400;
  camera.cx = camera.cy = 200;
  camera.fx = 310;
  camera.fy = 290;
  camera.distortion = {-0.25, 0.08, 0.004, -0.006, 0.01};
  const std::vector<cv::Point3d> points = {{-400, -300, 1000}, {420, -250, 1100}, {300, 380, 1050}, {5, -9, 900}};
  const cv::Matx33d matrix(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  std::vector<cv::Point2d> expected;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, camera.distortion, expected);
  for (size_t i = 0; i < points.size(); ++i) {
    // A triangle of 3 mm around the point covers the pixel next to its projection.
    const float x = points[i].x, y = points[i].y, z = points[i].z;
    const std::vector<float> speck = {x - 3, y - 3, z, x + 3, y - 3, z, x, y + 4, z};
    const ImageGray mask = render_silhouette(speck, std::vector<int32_t>{0, 1, 2}, camera);
    ASSERT_GT(count(mask), 0);
    double mean_x = 0, mean_y = 0;
    for (int p = 0; p < 400 * 400; ++p) {
      if (!mask.pixels[p]) continue;
      mean_x += p % 400;
      mean_y += p / 400;
    }
    EXPECT_LT(std::hypot(mean_x / count(mask) - expected[i].x, mean_y / count(mask) - expected[i].y), kSpeckPx) << i;
  }
}

}  // namespace
}  // namespace livecap
