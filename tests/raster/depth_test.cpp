#include "raster/depth.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "livecap/error.h"
#include "raster/layout.h"
#include "scenes.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kEmpty = std::numeric_limits<double>::infinity();

struct Hit {
  double depth = kEmpty;
  bool near_edge = false;  // a triangle's edge passes so close to the ray that rounding decides
};

// Independent of projection and edge functions: solves origin + s * ray = a + u (b - a) + v (c - a) in double.
Hit cast_ray(const Mesh& mesh, const Camera& camera, int x, int y) {
  const Eigen::Vector3d ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  Hit hit;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    Eigen::Vector3d p[3];
    bool near = false;
    for (int k = 0; k < 3; ++k) {
      p[k] = Eigen::Map<const Eigen::Vector3f>(mesh.positions.data() + 3 * mesh.triangles[3 * t + k]).cast<double>();
      near |= !(p[k].z() > 100);
    }
    if (near) continue;
    Eigen::Matrix3d system;
    system << ray, p[0] - p[1], p[0] - p[2];
    const Eigen::Vector3d solution = system.partialPivLu().solve(p[0]);
    const double u = solution[1], v = solution[2];
    const double inside = std::min({u, v, 1 - u - v});
    if (std::abs(inside) < test::kRasterEdge) hit.near_edge = true;
    if (inside >= 0) hit.depth = std::min(hit.depth, solution[0]);
  }
  return hit;
}

void expect_like_rays(ocl::DeviceContext& device, const Mesh& mesh, const Camera& camera) {
  DepthRasterizer raster(device, mesh, camera.width, camera.height);
  raster.render(ocl::Buffer<float>(device, mesh.positions), camera);
  const std::vector<float> depth = raster.depth().read_all();
  const std::vector<int32_t> ids = raster.triangle_ids().read_all();
  int covered = 0, doubtful = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const size_t p = size_t(y) * camera.width + x;
      ASSERT_EQ(std::isinf(depth[p]), ids[p] < 0);
      const Hit hit = cast_ray(mesh, camera, x, y);
      if (hit.near_edge) {
        ++doubtful;
        continue;
      }
      if (hit.depth == kEmpty) {
        ASSERT_TRUE(std::isinf(depth[p])) << x << "," << y;
      } else {
        ++covered;
        ASSERT_NEAR(depth[p], hit.depth, test::kRasterDepthRelative * hit.depth) << x << "," << y;
      }
    }
  }
  EXPECT_GT(covered, 0);
  EXPECT_LT(doubtful, camera.width * camera.height / 20);
}

TEST(Depth, RandomTrianglesMatchRays) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (int width : {7, 63, 65})
      expect_like_rays(device, test::random_triangles(40, width), test::small_camera(width, 49));
    Mesh tall = test::random_triangles(10, 5);
    for (size_t i = 2; i < tall.positions.size(); i += 3) tall.positions[i] = 200 + 0.2f * tall.positions[i];
    expect_like_rays(device, tall, test::small_camera(131, 2 * LC_RASTER_ROWS + 5));
  });
}

TEST(Depth, SphereMatchesRaysAndHasNoHoles) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Mesh mesh = test::sphere({30, -20, 1500}, 500, 20, 33);
    const Camera camera = test::small_camera(97, 101);
    expect_like_rays(device, mesh, camera);
    DepthRasterizer raster(device, mesh, camera.width, camera.height);
    raster.render(ocl::Buffer<float>(device, mesh.positions), camera);
    const ImageGray mask = raster.read_mask();
    // Along every row a convex body covers one run of pixels.
    for (int y = 0; y < mask.height; ++y) {
      int starts = 0;
      for (int x = 0; x < mask.width; ++x) {
        const bool on = mask.pixels[size_t(y) * mask.width + x];
        starts += on && (x == 0 || !mask.pixels[size_t(y) * mask.width + x - 1]);
      }
      EXPECT_LE(starts, 1) << "row " << y;
    }
  });
}

TEST(Depth, EdgesThroughPixelCentresLeaveNoGap) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    // Corners and diagonals of every square fall on pixel centres, but for rounding.
    Camera camera = test::small_camera(60, 60);
    camera.cx = camera.cy = 29;
    for (int cell_px : {3, 5, 7}) {
      for (float z : {777.77f, 1234.567f, 3141.59f}) {
        Mesh mesh;
        const int cells = 42 / cell_px;
        test::add_plane(mesh, 0, 0, 1, z, cells);
        for (int i = 0; i < mesh.n_vertices(); ++i) {
          for (int k = 0; k < 2; ++k) {
            const float at_px = std::round(mesh.positions[3 * i + k] * cells) * cell_px - 20;
            mesh.positions[3 * i + k] = at_px * z / static_cast<float>(k == 0 ? camera.fx : camera.fy);
          }
        }
        DepthRasterizer raster(device, mesh, 60, 60);
        raster.render(ocl::Buffer<float>(device, mesh.positions), camera);
        const ImageGray mask = raster.read_mask();
        for (int y = 10; y < 29 - 20 + cells * cell_px; ++y) {
          for (int x = 10; x < 29 - 20 + cells * cell_px; ++x) EXPECT_EQ(mask.pixels[y * 60 + x], 255) << x << "," << y;
        }
      }
    }
  });
}

TEST(Depth, ClosedMeshesCoverTheSameWithoutTheirFarFaces) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Mesh closed = test::sphere({0, 0, 1500}, 500, 12, 17);
    Mesh open = closed;  // one extra triangle with an open edge, too small to cover a pixel
    const float speck[] = {4000, 0, 1500, 4000.01f, 0, 1500, 4000, 0.01f, 1500};
    for (int k = 0; k < 3; ++k) open.triangles.push_back(open.n_vertices() + k);
    open.positions.insert(open.positions.end(), speck, speck + 9);
    const Camera camera = test::small_camera(90, 80);
    DepthRasterizer one(device, closed, 90, 80), both(device, open, 90, 80);
    one.render(ocl::Buffer<float>(device, closed.positions), camera);
    both.render(ocl::Buffer<float>(device, open.positions), camera);
    EXPECT_EQ(one.read_mask().pixels, both.read_mask().pixels);
    EXPECT_EQ(one.depth().read_all(), both.depth().read_all());
  });
}

TEST(Depth, HugeAndOffScreenTriangles) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Mesh mesh = test::random_triangles(3, 5);
    for (float& p : mesh.positions) p *= 3;                                  // partly outside the picture
    for (int k = 0; k < 3; ++k) mesh.positions[3 * k + 2] = 900 + 10.f * k;  // one across all of it
    mesh.positions[0] = -90000, mesh.positions[1] = -80000;
    mesh.positions[3] = 90000, mesh.positions[4] = -70000;
    mesh.positions[6] = 100, mesh.positions[7] = 95000;
    expect_like_rays(device, mesh, test::small_camera(64, 40));
  });
}

TEST(Depth, NearBehindAndNotFiniteTrianglesAreLeftOut) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Camera camera = test::small_camera(40, 30);
    for (float bad : {99.f, -500.f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      Mesh mesh;
      test::add_plane(mesh, -500, -500, 1000, 800, 1);
      mesh.positions[2] = bad;  // corner of the first triangle only
      DepthRasterizer raster(device, mesh, 40, 30);
      raster.render(ocl::Buffer<float>(device, mesh.positions), camera);
      for (int32_t id : raster.triangle_ids().read_all()) EXPECT_NE(id, 0);
    }
  });
}

TEST(Depth, EqualDepthGoesToTheLowerIdAndRepeats) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Mesh mesh;
    test::add_plane(mesh, -500, -500, 1000, 900, 3);
    const size_t once = mesh.triangles.size();
    mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.begin() + once);
    const Camera camera = test::small_camera(65, 63);
    DepthRasterizer raster(device, mesh, 65, 63);
    const ocl::Buffer<float> positions(device, mesh.positions);
    raster.render(positions, camera);
    const auto ids = raster.triangle_ids().read_all();
    const auto depth = raster.depth().read_all();
    for (int32_t id : ids) EXPECT_LT(id, static_cast<int>(once / 3));
    raster.render(positions, camera);
    EXPECT_EQ(ids, raster.triangle_ids().read_all());
    EXPECT_EQ(depth, raster.depth().read_all());
  });
}

// Whatever was drawn before, with triangles or without.
TEST(Depth, DepthAloneIsThatOfWholePictures) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Mesh first = test::random_triangles(40, 1), second = test::random_triangles(40, 2);
    const Camera camera = test::small_camera(65, 63);
    const ocl::Buffer<float> here(device, first.positions), there(device, second.positions);
    DepthRasterizer whole(device, first, 65, 63), alone(device, first, 65, 63);
    whole.render(there, camera);
    const std::vector<float> depth_there = whole.depth().read_all();
    whole.render(here, camera);
    ASSERT_NE(whole.depth().read_all(), depth_there);
    alone.render(here, camera);
    alone.render_depth(there, camera);
    EXPECT_EQ(alone.depth().read_all(), depth_there);
    ocl::Buffer<uint8_t> mask(device, alone.read_mask().pixels);
    EXPECT_EQ(alone.intersection_over_union(mask), 1);
    whole.render(there, camera);
    EXPECT_EQ(alone.read_mask().pixels, whole.read_mask().pixels);
    whole.render(here, camera);
    EXPECT_LT(whole.intersection_over_union(mask), 1);
    alone.render(here, camera);
    EXPECT_EQ(alone.depth().read_all(), whole.depth().read_all());
    EXPECT_EQ(alone.triangle_ids().read_all(), whole.triangle_ids().read_all());
  });
}

// Rows that the last picture reached and this one does not.
TEST(Depth, WhatIsNoLongerReachedIsEmpty) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Camera camera = test::small_camera(65, 63);
    Mesh mesh;
    mesh.positions = {-200, -400, 1000, 200, -400, 1000, 0, -250, 1000};
    mesh.triangles = {0, 1, 2};
    std::vector<float> below = mesh.positions;
    for (size_t i = 1; i < below.size(); i += 3) below[i] += 600;
    const ocl::Buffer<float> high(device, mesh.positions), low(device, below);
    DepthRasterizer moved(device, mesh, 65, 63), fresh(device, mesh, 65, 63);
    moved.render(high, camera);
    const std::vector<float> depth_high = moved.depth().read_all();
    moved.render(low, camera);
    fresh.render(low, camera);
    ASSERT_NE(moved.depth().read_all(), depth_high);
    EXPECT_EQ(moved.depth().read_all(), fresh.depth().read_all());
    EXPECT_EQ(moved.triangle_ids().read_all(), fresh.triangle_ids().read_all());
  });
}

TEST(Depth, EmptyAndSingleTriangleMeshes) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Camera camera = test::small_camera(17, 9);
    for (int n : {0, 1}) {
      const Mesh mesh = test::random_triangles(n, 1);
      DepthRasterizer raster(device, mesh, 17, 9);
      raster.render(ocl::Buffer<float>(device, mesh.positions), camera);
      for (int32_t id : raster.triangle_ids().read_all()) EXPECT_LT(id, n);
    }
    EXPECT_THROW(DepthRasterizer(device, Mesh{}, 0, 9), ConfigError);
    Mesh broken = test::random_triangles(1, 1);
    broken.triangles[1] = 3;
    EXPECT_THROW(DepthRasterizer(device, broken, 17, 9), LogicError);
  });
}

TEST(Depth, OverlapIsCounted) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (int width : {1, 15, 16, 33, 70}) {
      Camera camera;
      camera.width = width;
      camera.height = 21;
      camera.fx = camera.fy = 100;
      camera.cx = 0.5 * (width - 1);
      camera.cy = 10;
      Mesh mesh;  // a triangle over a part of the picture
      mesh.positions = {-100, -60, 1000, 300, -70, 1000, -90, 150, 1000};
      mesh.triangles = {0, 2, 1};
      DepthRasterizer raster(device, mesh, width, camera.height);
      raster.render(ocl::Buffer<float>(device, mesh.positions), camera);
      std::vector<uint8_t> mask(size_t(width) * camera.height);
      for (size_t p = 0; p < mask.size(); ++p) mask[p] = p % 3 == 0 ? 255 : p % 5 == 0 ? 128 : 127;
      const ImageGray drawn = raster.read_mask();
      int both = 0, either = 0;
      for (size_t p = 0; p < mask.size(); ++p) {
        both += drawn.pixels[p] && mask[p] > 127;
        either += drawn.pixels[p] || mask[p] > 127;
      }
      EXPECT_EQ(raster.intersection_over_union(ocl::Buffer<uint8_t>(device, mask)), double(both) / either) << width;
      EXPECT_THROW(raster.intersection_over_union(ocl::Buffer<uint8_t>(device, mask.size() + 1)), LogicError);
    }
  });
}

}  // namespace
}  // namespace livecap
