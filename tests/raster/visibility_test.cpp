#include "raster/visibility.h"

#include <gtest/gtest.h>

#include <set>

#include "livecap/error.h"
#include "scenes.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

struct Seen {
  std::vector<int32_t> visible;
  std::vector<int32_t> contour;  // indices
};

Seen look(ocl::DeviceContext& device, const Mesh& mesh, const Camera& camera, const VisibilityOptions& options = {}) {
  DepthRasterizer raster(device, mesh, camera.width, camera.height);
  SurfaceVisibility visibility(device, mesh, options);
  const ocl::Buffer<float> positions(device, mesh.positions);
  const ocl::Buffer<float> normals(device, vertex_normals(mesh.positions, mesh.triangles));
  raster.render(positions, camera);
  visibility.find_visible(positions, normals, raster);
  visibility.find_contour(raster);
  SurfaceVisibility both(device, mesh, options);
  both.find_visible_and_contour(positions, normals, raster);
  Seen seen{visibility.visible().read_all(), visibility.read_contour()};
  EXPECT_EQ(both.visible().read_all(), seen.visible);
  EXPECT_EQ(both.read_contour(), seen.contour);
  return seen;
}

Camera camera_of(int width, int height, double focal) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

TEST(Visibility, PlaneHidesWhatLiesBehindIt) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Mesh mesh;
    test::add_plane(mesh, -150, -150, 300, 1000, 10);  // in front, +-30 px
    const int n_front = mesh.n_vertices();
    test::add_plane(mesh, -600, -600, 1200, 2000, 24);  // behind, +-60 px
    const Camera camera = camera_of(161, 159, 200);
    const Seen seen = look(device, mesh, camera);
    int hidden = 0;
    for (int i = 0; i < mesh.n_vertices(); ++i) {
      if (i < n_front) {
        EXPECT_EQ(seen.visible[i], 1) << i;
        continue;
      }
      const double u = mesh.positions[3 * i] / 10, v = mesh.positions[3 * i + 1] / 10;  // px from the centre
      const double rim = std::max(std::abs(u), std::abs(v)) - 30;
      if (std::abs(rim) <= 2) continue;  // the tolerance zone of the 3x3 neighbourhood
      EXPECT_EQ(seen.visible[i], rim > 0 ? 1 : 0) << u << "," << v;
      hidden += rim < 0;
    }
    EXPECT_GT(hidden, 100);
  });
}

TEST(Visibility, VerticesThatFaceAwayOrLeaveThePictureAreNotVisible) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Eigen::Vector3f center(0, 0, 1500);
    const Mesh mesh = test::sphere(center, 300, 24, 32);
    const Camera camera = camera_of(140, 100, 300);  // the sphere (about +-61 px) is cut above and below
    const Seen seen = look(device, mesh, camera);
    int visible = 0;
    for (int i = 0; i < mesh.n_vertices(); ++i) {
      const Eigen::Map<const Eigen::Vector3f> p(mesh.positions.data() + 3 * i);
      const float cosine = -(p - center).normalized().dot(p.normalized());
      const float v = 300 * p.y() / p.z() + 49.5f;
      if (std::abs(cosine) < 0.1f || std::abs(v) < 1 || std::abs(v - 99) < 1) continue;
      const bool expected = cosine > 0 && v > 0 && v < 99;
      EXPECT_EQ(seen.visible[i], expected) << i;
      visible += expected;
    }
    EXPECT_GT(visible, 100);
  });
}

TEST(Visibility, ContourOfASphereLiesOnItsAnalyticOutline) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const double focal = 400, distance = 1500, radius = 300;
    const Mesh mesh = test::sphere({0, 0, 1500}, 300, 45, 71);
    const Camera camera = camera_of(220, 211, focal);
    const Seen seen = look(device, mesh, camera);
    // A sphere on the optical axis shows as a disc of this radius.
    const double outline_px = focal * radius / std::sqrt(distance * distance - radius * radius);
    std::set<int> sectors;
    for (int32_t i : seen.contour) {
      const Eigen::Map<const Eigen::Vector3f> p(mesh.positions.data() + 3 * i);
      const double u = focal * p.x() / p.z(), v = focal * p.y() / p.z();
      EXPECT_NEAR(std::hypot(u, v), outline_px, test::kContourPx);
      sectors.insert(static_cast<int>(std::floor(std::atan2(v, u) / M_PI * 12)));
    }
    EXPECT_GE(seen.contour.size(), 60u);
    EXPECT_LE(seen.contour.size(), 300u);
    EXPECT_GE(sectors.size(), 24u) << "the contour has gaps";
    EXPECT_TRUE(std::is_sorted(seen.contour.begin(), seen.contour.end()));
  });
}

TEST(Visibility, InnerOutlinesAndThePictureBorderAreNoContour) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    // A small sphere in front of a plane that fills the picture: every outline has the plane behind it.
    Mesh mesh = test::sphere({0, 0, 1000}, 150, 20, 30);
    test::add_plane(mesh, -1500, -1500, 3000, 1800, 4);
    EXPECT_TRUE(look(device, mesh, camera_of(100, 90, 150)).contour.empty());
  });
}

TEST(Visibility, OpenEdgesAreContour) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Mesh mesh;
    test::add_plane(mesh, -200, -200, 400, 1000, 4);
    const Seen seen = look(device, mesh, camera_of(120, 120, 200));
    EXPECT_EQ(seen.contour.size(), 16u);  // the rim of 5x5 vertices
  });
}

TEST(Visibility, SmallMeshesAndWrongBuffers) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Camera camera = camera_of(20, 20, 30);
    for (int n : {0, 1, 21, 22}) {
      const Mesh mesh = test::random_triangles(n, 7);
      EXPECT_EQ(look(device, mesh, camera).visible.size(), size_t(3) * n);
    }
    const Mesh mesh = test::random_triangles(2, 7);
    DepthRasterizer other(device, test::random_triangles(3, 7), 20, 20);
    EXPECT_THROW(SurfaceVisibility(device, mesh).find_contour(other), LogicError);
    VisibilityOptions options;
    options.contour_radius_px = 0;
    EXPECT_THROW(SurfaceVisibility(device, mesh, options), ConfigError);
  });
}

}  // namespace
}  // namespace livecap
