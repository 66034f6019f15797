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

// Whether the disc around the vertex's pixel leaves the mesh within the picture and nothing there hides the vertex.
bool is_at_outline(const std::vector<float>& depth, const Camera& camera, int x, int y, double z,
                   const VisibilityOptions& options) {
  bool leaves = false;
  double farthest = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (std::hypot(u - x, v - y) > options.contour_radius_px) continue;
      const float d = depth[size_t(v) * camera.width + u];
      if (std::isinf(d)) leaves = true;
      if (!std::isinf(d)) farthest = std::max(farthest, double(d));
    }
  }
  return leaves && (farthest == 0 || z <= farthest + options.contour_tolerance_mm);
}

// Two spheres, one before the other, both partly outside the picture: vertex by vertex for every radius.
TEST(Visibility, ContourIsWhatItsDiscsSay) {
  Mesh mesh = test::sphere({-230, 20, 1500}, 250, 15, 23);
  const Mesh behind = test::sphere({160, -60, 1700}, 260, 15, 23);
  const int first = mesh.n_vertices();
  mesh.positions.insert(mesh.positions.end(), behind.positions.begin(), behind.positions.end());
  for (int32_t corner : behind.triangles) mesh.triangles.push_back(first + corner);
  const Camera camera = camera_of(61, 47, 130);
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < mesh.n_vertices(); ++i) {
    const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3f>(&mesh.positions[3 * i]).cast<double>();
    pixels.emplace_back(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
  }
  std::vector<bool> front(mesh.n_vertices(), false), back(mesh.n_vertices(), false);
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const int32_t* corner = &mesh.triangles[3 * t];
    const Eigen::Vector2d a = pixels[corner[1]] - pixels[corner[0]], b = pixels[corner[2]] - pixels[corner[0]];
    for (int k = 0; k < 3; ++k) (a.x() * b.y() - a.y() * b.x() < 0 ? front : back)[corner[k]] = true;
  }
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    DepthRasterizer raster(device, mesh, camera.width, camera.height);
    raster.render(ocl::Buffer<float>(device, mesh.positions), camera);
    const std::vector<float> depth = raster.depth().read_all();
    for (int radius : {1, 2, 3, 4}) {
      VisibilityOptions options;
      options.contour_radius_px = radius;
      const std::vector<int32_t> contour = look(device, mesh, camera, options).contour;
      const std::set<int32_t> found(contour.begin(), contour.end());
      int n_contour = 0, n_inner = 0;
      for (int i = 0; i < mesh.n_vertices(); ++i) {
        const int x = int(std::lround(pixels[i].x())), y = int(std::lround(pixels[i].y()));
        if (x < 0 || y < 0 || x >= camera.width || y >= camera.height || !front[i] || !back[i]) continue;
        const bool expected = is_at_outline(depth, camera, x, y, mesh.positions[3 * i + 2], options);
        EXPECT_EQ(found.count(i) == 1, expected) << "vertex " << i << ", radius " << radius;
        ++(expected ? n_contour : n_inner);
      }
      EXPECT_EQ(int(contour.size()), n_contour);
      EXPECT_GT(n_contour, 15);
      EXPECT_GT(n_inner, 0);
    }
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

TEST(Visibility, OnlyCandidatesAreContour) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const Mesh& mesh : {test::sphere({0, 0, 1500}, 300, 45, 71), test::random_triangles(40, 3)}) {
      const Camera camera = camera_of(220, 211, 400);
      std::vector<uint8_t> among(mesh.n_vertices());
      for (size_t i = 0; i < among.size(); ++i) among[i] = i % 3 != 0;
      std::vector<int32_t> expected = look(device, mesh, camera).contour;
      ASSERT_GT(expected.size(), 20u);
      std::erase_if(expected, [&](int32_t i) { return !among[i]; });
      DepthRasterizer raster(device, mesh, camera.width, camera.height);
      SurfaceVisibility visibility(device, mesh);
      const ocl::Buffer<int32_t> candidates = visibility.contour_candidates(among);
      const ocl::Buffer<float> positions(device, mesh.positions);
      const ocl::Buffer<float> normals(device, vertex_normals(mesh.positions, mesh.triangles));
      raster.render(positions, camera);
      visibility.find_contour(raster, candidates);
      EXPECT_EQ(visibility.read_contour(), expected);
      visibility.find_visible_and_contour(positions, normals, raster, candidates);
      EXPECT_EQ(visibility.read_contour(), expected);
      EXPECT_THROW(visibility.contour_candidates(std::vector<uint8_t>(7)), LogicError);
    }
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
