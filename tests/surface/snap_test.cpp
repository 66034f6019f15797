#include "surface/snap.h"

#include <gtest/gtest.h>

#include "support/kernel_bodies.h"
#include "support/tolerances.h"
#include "surface/scene.h"

namespace livecap {
namespace {

using test::Scene;

// A sphere whose image is a circle of 75 px about (160, 120); the silhouette is one of `radius_px`.
Scene ball(double radius_px, int subdivisions = 4) {
  Scene s = test::make_scene(test::icosphere(subdivisions, 300, {0, 0, 2000}), 321, 241, 490);
  test::set_distance(s, [&](double x, double y) { return std::hypot(x - 160, y - 120) - radius_px; });
  test::mark_rim(s, 0.06);
  return s;
}

double distance_px(const Scene& s, const std::vector<float>& v, int i, double radius_px) {
  const auto uv = s.project(v, i);
  return std::hypot(uv[0] - 160, uv[1] - 120) - radius_px;
}

std::vector<float> snapped(ocl::DeviceContext& device, const Scene& s, const SnapOptions& options = {},
                           bool parts = false, std::vector<float>* rings = nullptr) {
  const test::DeviceScene d(device, s);
  Snapper snapper(device, s.actor, std::make_shared<SurfaceDomain>(device, s.actor, s.camera), options);
  ocl::Buffer<float> vertices(device, s.start);
  snapper.snap({.frame = d.frame,
                .contour_flag = d.contour,
                .normals = d.normals,
                .part_image = parts ? &d.part_image : nullptr,
                .vertex_part = parts ? &d.vertex_part : nullptr},
               vertices);
  if (rings) *rings = snapper.rings();
  return vertices.read_all();
}

// Breadth-first distance in edges from the flagged vertices.
std::vector<int> edge_distance(const Scene& s, const std::vector<char>& from) {
  const OneRing ring = one_ring(s.n(), s.actor.mesh.triangles);
  std::vector<int> distance(s.n(), 1000), queue;
  for (int i = 0; i < s.n(); ++i)
    if (from[i]) {
      distance[i] = 0;
      queue.push_back(i);
    }
  for (size_t head = 0; head < queue.size(); ++head)
    for (int k = ring.offsets[queue[head]]; k < ring.offsets[queue[head] + 1]; ++k) {
      const int j = ring.neighbors[k];
      if (distance[j] == 1000) {
        distance[j] = distance[queue[head]] + 1;
        queue.push_back(j);
      }
    }
  return distance;
}

TEST(Snap, ContourReachesTheSilhouetteAndOnlyTheBandFollows) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const double radius : {70.0, 81.0}) {
      const Scene s = ball(radius);
      const SnapOptions options;
      const std::vector<float> v = snapped(device, s, options);
      std::vector<char> contour(s.contour.begin(), s.contour.end());
      const std::vector<int> distance = edge_distance(s, contour);
      double before = 0, after = 0, moved_in_band = 0, outermost = 0;
      int n_contour = 0;
      for (int i = 0; i < s.n(); ++i) {
        EXPECT_EQ(v[3 * i + 2], s.start[3 * i + 2]) << "depth of " << i;
        const double move = std::hypot(v[3 * i] - s.start[3 * i], v[3 * i + 1] - s.start[3 * i + 1]);
        if (distance[i] > options.n_rings) {
          EXPECT_EQ(move, 0) << i;
        } else if (distance[i] > 0) {
          moved_in_band = std::max(moved_in_band, move);
          if (distance[i] == options.n_rings) outermost = std::max(outermost, move);
        }
        if (s.contour[i]) {
          ++n_contour;
          before = std::max(before, std::abs(distance_px(s, s.start, i, radius)));
          after = std::max(after, std::abs(distance_px(s, v, i, radius)));
        }
      }
      EXPECT_GT(n_contour, 20);
      EXPECT_GT(before, 4);
      EXPECT_LT(after, 0.5) << radius;
      EXPECT_GT(moved_in_band, 0);
      EXPECT_LT(outermost, 0.5 * moved_in_band);
    }
  });
}

// An open tube: vertices of degree 3 to 6 share slices. Its sides stand at 75 px from the middle, the silhouette at 80.
Scene open_tube() {
  Scene s = test::make_scene(test::tube(40, 30, 300, 900, {0, 0, 2000}), 321, 241, 490);
  test::set_distance(s, [](double x, double) { return std::abs(x - 160) - 80; });
  test::mark_rim(s, 0.1);
  return s;
}

TEST(Snap, WarpEqualsTheSameSweepsOnTheHost) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Scene s = open_tube();
    const OneRing ring = one_ring(s.n(), s.actor.mesh.triangles);
    SnapOptions options;
    options.n_rings = 0;
    std::vector<float> rings;
    const std::vector<float> alone = snapped(device, s, options, false, &rings);
    std::vector<char> from(s.n());
    for (int i = 0; i < s.n(); ++i) from[i] = rings[i] == 0;
    const std::vector<int> distance = edge_distance(s, from);
    options.n_rings = 3;
    options.relaxations = 2;
    std::vector<double> x(s.n(), 0.0);  // all moves are along x
    for (int i = 0; i < s.n(); ++i) x[i] = double(alone[3 * i]) - s.start[3 * i];
    const auto mean = [&](const std::vector<double>& values, int i, int only_at) {
      double sum = 0, count = 0;
      for (int k = ring.offsets[i]; k < ring.offsets[i + 1]; ++k) {
        const int j = ring.neighbors[k];
        if (only_at >= 0 && distance[j] != only_at) continue;
        sum += values[j];
        count += 1;
      }
      return sum / count;
    };
    for (int r = 1; r <= 3; ++r)
      for (int i = 0; i < s.n(); ++i)
        if (distance[i] == r) x[i] = mean(x, i, r - 1) * (4.0 - r) / (5.0 - r);
    for (int sweep = 0; sweep < 2; ++sweep) {
      const std::vector<double> before = x;
      for (int i = 0; i < s.n(); ++i)
        if (distance[i] >= 1 && distance[i] <= 3) x[i] = mean(before, i, -1);
    }
    const std::vector<float> v = snapped(device, s, options);
    double largest = 0;
    for (int i = 0; i < s.n(); ++i) {
      EXPECT_NEAR(v[3 * i] - s.start[3 * i], x[i], test::kHarmonicBand) << i;
      largest = std::max(largest, std::abs(x[i]));
    }
    EXPECT_GT(largest, 10);
  });
}

// Where PoCL runs the body for GPUs: it has no fence between work-groups, so the warp goes round by round, which the
// snapper finds out beforehand. A GPU with a fence does the same thing twice here.
TEST(Snap, IsTheSameWhereGroupsCannotWait) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    if (device.is_cpu()) return;
    ocl::DeviceInfo info = device.info();
    info.compute_units = 3;
    ocl::DeviceContext several(info);
    const Scene s = open_tube();
    EXPECT_EQ(snapped(several, s), snapped(device, s));
  });
}

TEST(Snap, BandIsHarmonicAfterManySweeps) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Scene s = open_tube();
    SnapOptions options;
    options.relaxations = 400;
    std::vector<float> rings;
    const std::vector<float> v = snapped(device, s, options, false, &rings);
    const OneRing ring = one_ring(s.n(), s.actor.mesh.triangles);
    int n_band = 0, n_border = 0;
    for (int i = 0; i < s.n(); ++i) {
      if (rings[i] < 1 || rings[i] > float(options.n_rings)) continue;
      ++n_band;
      n_border += ring.offsets[i + 1] - ring.offsets[i] < 6;
      for (int a = 0; a < 2; ++a) {
        double mean = 0;
        for (int k = ring.offsets[i]; k < ring.offsets[i + 1]; ++k) {
          const int j = ring.neighbors[k];
          mean += (double(v[3 * j + a]) - s.start[3 * j + a]) / (ring.offsets[i + 1] - ring.offsets[i]);
        }
        EXPECT_NEAR(v[3 * i + a] - s.start[3 * i + a], mean, test::kHarmonicBand) << i;
      }
    }
    EXPECT_GT(n_band, 100);
    EXPECT_GT(n_border, 10);
  });
}

TEST(Snap, RigidFarAndForeignVerticesStay) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    Scene s = ball(80);
    for (int i = 0; i < s.n(); ++i)
      if (s.start[3 * i] > 0) s.actor.rigidity[i] = 50.0f;
    std::vector<float> v = snapped(device, s);
    int n_moved = 0;
    for (int i = 0; i < s.n(); ++i)
      for (int a = 0; a < 3; ++a) {
        if (s.start[3 * i] > 0) {
          EXPECT_EQ(v[3 * i + a], s.start[3 * i + a]) << i;
        } else if (v[3 * i + a] != s.start[3 * i + a]) {
          ++n_moved;
        }
      }
    EXPECT_GT(n_moved, 100);

    // Farther than max_move_px.
    EXPECT_EQ(snapped(device, ball(95)), ball(95).start);
    // Another part's region.
    Scene foreign = ball(80);
    foreign.part_image.assign(foreign.part_image.size(), 2);
    EXPECT_EQ(snapped(device, foreign, {}, true), foreign.start);
    foreign.vertex_part.assign(foreign.vertex_part.size(), 2);
    EXPECT_NE(snapped(device, foreign, {}, true), foreign.start);
    // Inside, with the normal away from the contour found.
    Scene inverted = ball(80);
    for (float& x : inverted.normals) x = -x;
    EXPECT_EQ(snapped(device, inverted), inverted.start);
    // Nothing on the contour.
    Scene nothing = ball(80);
    nothing.contour.assign(nothing.contour.size(), 0);
    EXPECT_EQ(snapped(device, nothing), nothing.start);
    // Behind the camera and not a number.
    Scene behind = ball(80, 2);
    for (int i = 0; i < behind.n(); ++i) behind.start[3 * i + 2] = i % 2 ? -500.0f : std::nanf("");
    const std::vector<float> same = snapped(device, behind);
    for (size_t k = 0; k < same.size(); k += 3) EXPECT_EQ(same[k], behind.start[k]);
  });
}

TEST(Snap, RepeatsBitForBit) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Scene s = ball(79.3);
    EXPECT_EQ(snapped(device, s), snapped(device, s));
  });
}

}  // namespace
}  // namespace livecap
