#include "acquire/surface_color.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "acquire/body_rig.h"
#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

// A long body whose upper end follows the head and whose lower one an arm.
TEST(SurfaceColor, HeadsHaveTwiceTheTexelsPerMmAndChartsOfTheirOwn) {
  const meshing::Surface surface = meshing::extract_surface(
      [](const Vector3d& p) { return (p - Vector3d(0, std::clamp(p.y(), -300.0, 300.0), 0)).norm() - 80; },
      {-110, -410, -110}, {110, 410, 110}, 20);
  std::vector<meshing::Influences> weights;
  const auto bone_at = [](double y) { return y > 150 ? kHeadBone : y < -150 ? kLeftForeArmBone : kSpineBone; };
  for (const Vector3d& p : surface.vertices) {
    meshing::Influences influences{};
    influences[0] = {bone_at(p.y()), 1};
    weights.push_back(influences);
  }
  constexpr int kTexels = 512;
  const meshing::Atlas atlas = body_atlas(surface, weights, kTexels);
  double head = 0, rest = 0;  // texels per mm, the most of all edges: those that the projection does not shorten
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3],
                c = surface.triangles[t][(k + 2) % 3];
      const double texels =
          kTexels * (atlas.uvs[atlas.triangles[t][k]] - atlas.uvs[atlas.triangles[t][(k + 1) % 3]]).norm();
      const double density = texels / (surface.vertices[a] - surface.vertices[b]).norm();
      const auto all_of = [&](auto bone) {
        for (int vertex : {a, b, c})
          if (weights[vertex][0].bone != bone) return false;
        return true;
      };
      if (all_of(kHeadBone)) head = std::max(head, density);
      if (all_of(kSpineBone) || all_of(kLeftForeArmBone)) rest = std::max(rest, density);
    }
  EXPECT_NEAR(head / rest, 2, test::kTexelRatio);
  EXPECT_GT(atlas.vertex.size(), surface.vertices.size());
}

}  // namespace
}  // namespace livecap::acquire
